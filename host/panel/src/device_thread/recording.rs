//! Recordings, while the device is live.

use super::DeviceThread;
use crate::shared::Outcome;
use crepitus_client::Transport;
use crepitus_files::names::is_reserved;
use crepitus_files::output::{folder_of, temporary_in};
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, Values};
use crepitus_recording::{
    Begin, Damage, Metadata, Recorder, Recording, is_recording, parquet_writer,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::Instant;

/// Longest name.
const MOST_NAME: usize = 60;

/// A recording in progress.
pub(super) struct Recorded {
    recorder: Recorder,
    /// Id of the recording: what has its file's name in the end may be another one.
    id: String,
    began: Instant,
    /// A block has come.
    has_begun: bool,
    is_announced: bool,
}

impl Recorded {
    /// The file's name.
    pub(super) fn name(&self) -> String {
        let name = self.recorder.path().file_name();
        name.unwrap_or_default().to_string_lossy().into_owned()
    }

    pub(super) fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    pub(super) fn announce(&mut self, revision: Revision, values: &Values) {
        self.is_announced = true;
        self.recorder.announce(revision, values);
    }
}

/// Extension of the files that are left.
pub(super) fn extension() -> &'static str {
    if parquet_writer().is_some() {
        "parquet"
    } else {
        "crepitus"
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    pub(super) fn set_recording(&mut self, running: bool, name: &str) -> Outcome {
        if !running {
            self.end_recording();
            return Ok(Value::Null);
        }
        let Some(folder) = &self.sessions else {
            return Err(
                "this panel stores nothing: start it with `--sessions FOLDER` to say where"
                    .to_owned(),
            );
        };
        // It would hold the levels.
        self.experiment.check_none()?;
        if self.lesson.is_some() {
            return Err("the lesson records each trial by itself".to_owned());
        }
        let is_plain = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
        let name = name.trim();
        let count = name.chars().count();
        if !(1..=MOST_NAME).contains(&count) || !name.chars().all(is_plain) {
            return Err(format!(
                "invalid name {name:?}: expected 1 to {MOST_NAME} letters, digits, spaces, `-` and `_`"
            ));
        }
        if is_reserved(name) {
            return Err(format!(
                "invalid name {name:?}: Windows has no file of this name"
            ));
        }
        let file = folder.join(name).with_extension(extension());
        std::fs::create_dir_all(folder)
            .map_err(|e| format!("{}: cannot be created: {e}", folder.display()))?;
        self.begin_recording(&file, name)?;
        Ok(json!({ "file": name }))
    }

    /// Begins a recording, in place of the one that is running.
    pub(super) fn begin_recording(&mut self, file: &Path, title: &str) -> Result<(), String> {
        self.end_recording();
        let handshake = self.client.handshake();
        let metadata = Metadata::new(title, &handshake.comms, handshake.drive.as_ref());
        let recorder = Recorder::create(file, &metadata).map_err(|error| error.to_string())?;
        self.recording = Some(Recorded {
            recorder,
            id: metadata.id,
            began: Instant::now(),
            has_begun: false,
            is_announced: false,
        });
        self.status_is_due = true;
        Ok(())
    }

    pub(super) fn record(&mut self, block: &Block) {
        let Some(recorded) = &mut self.recording else {
            return;
        };
        let mut take = || {
            if !recorded.has_begun {
                recorded.has_begun = true;
                // What the device has not sent before this block was before the recording.
                recorded.recorder.subscribed(Begin {
                    first_tick: block.first_tick,
                    dropped: block.dropped,
                    start: block.flags.start(),
                })?;
            }
            if !recorded.is_announced {
                recorded.announce(block.revision, &self.values);
            }
            recorded.recorder.block(block)?;
            recorded.recorder.flush()
        };
        if let Err(error) = take() {
            self.message = Some(format!(
                "{error}; the recording ends here, what was written can be read"
            ));
            self.recording = None;
            self.status_is_due = true;
        }
    }

    /// Resumes the recording after a lost connection.
    pub(super) fn resume_recording(&mut self, begin: Begin) {
        let Some(recorded) = &mut self.recording else {
            return;
        };
        recorded.is_announced = false;
        if !recorded.has_begun {
            return;
        }
        if let Err(error) = recorded.recorder.subscribed(begin) {
            self.message = Some(error.to_string());
            self.recording = None;
        }
    }

    /// Ends the recording that is running; its Parquet file is made in the background.
    pub(super) fn end_recording(&mut self) {
        let Some(recorded) = self.recording.take() else {
            return;
        };
        self.status_is_due = true;
        let file = recorded.recorder.path().to_owned();
        let is_empty = recorded.recorder.totals().received == 0;
        if is_empty {
            let id = recorded.id.clone();
            drop(recorded);
            if is_recording(&file, &id) {
                let _ = std::fs::remove_file(&file);
            }
            return;
        }
        match recorded.recorder.finish() {
            Ok(_) => self.sealing.push(seal(file, recorded.id)),
            Err(error) => self.message = Some(error.to_string()),
        }
    }

    /// Reports on the page a file that could not be made.
    pub(super) fn check_files(&mut self) {
        while let Some(at) = self.sealing.iter().position(JoinHandle::is_finished) {
            if let Ok(Err(error)) = self.sealing.swap_remove(at).join() {
                self.message = Some(format!(
                    "no Parquet file was made of the recording: {error}; what was recorded is whole, in the format \
                     of a recording in progress"
                ));
                self.status_is_due = true;
            }
        }
    }

    /// Waits for the files that are being made.
    pub(super) fn wait_for_files(&mut self) {
        for thread in self.sealing.drain(..) {
            if let Ok(Err(error)) = thread.join() {
                eprintln!("warning: {error}");
            }
        }
    }
}

/// A thread that replaces a finished recording by its Parquet file, if this program can
/// write one. If that fails, or another file has its name now, the file stays as it is.
fn seal(file: PathBuf, id: String) -> JoinHandle<Result<(), String>> {
    thread::spawn(move || {
        let Some(write) = parquet_writer() else {
            return Ok(());
        };
        let failed = |e: &dyn std::fmt::Display| format!("{}: {e}", file.display());
        let recording = Recording::open(&file, Damage::Refuse).map_err(|e| failed(&e))?;
        let made = temporary_in(folder_of(&file)).map_err(|e| failed(&e))?;
        write(&recording, made.as_file(), &mut |_| true).map_err(|e| failed(&e))?;
        if !is_recording(&file, &id) {
            return Err(failed(&"another file has this name now"));
        }
        // Windows replaces no file that is open.
        drop(recording);
        made.persist(&file).map_err(|e| failed(&e.error))?;
        Ok(())
    })
}

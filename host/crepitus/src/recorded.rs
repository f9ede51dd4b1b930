//! Files of recordings: written while a device is followed, turned into their
//! final format when it has ended.

use crate::failure::{Failure, print, warn};
use crate::following::Follower;
use crate::interrupt;
use crate::line::{Line, failure};
use crate::progress::Progress;
use crate::shell;
use crate::status_line::StatusLine;
use crepitus_client::{Begin, Client, Event};
use crepitus_files::output::{folder_of, sync_folder_of, temporary_in};
use crepitus_protocol::Revision;
use crepitus_protocol::telemetry::Block;
use crepitus_recording::{
    Damage, Ending, Metadata, RecordError, Recorder, Recording, Totals, Write, is_recording,
    parquet_writer,
};
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A recording in progress.
pub(crate) struct Recorded {
    recorder: Recorder,
    /// Id of the recording: what has its file's name in the end may be another one.
    id: String,
    announced: Option<Revision>,
    status: StatusLine,
}

impl Recorded {
    /// Creates the file and subscribes. A file without samples is removed.
    pub(crate) fn begin(
        client: &mut Client<Line>,
        file: &Path,
        title: &str,
    ) -> Result<Self, Failure> {
        let handshake = client.handshake();
        let metadata = Metadata::new(title, &handshake.comms, handshake.drive.as_ref());
        let mut recorded = Self {
            recorder: Recorder::create(file, &metadata).map_err(not_begun)?,
            id: metadata.id,
            announced: None,
            status: StatusLine::new(),
        };
        let begun = client
            .subscribe()
            .map_err(failure)
            .and_then(|begin| recorded.resumed(begin));
        match begun {
            Ok(()) => Ok(recorded),
            Err(error) => {
                recorded.discard()?;
                Err(error)
            }
        }
    }

    /// Removes the file.
    fn discard(self) -> Result<(), Failure> {
        let file = self.recorder.path().to_owned();
        drop(self.recorder);
        if !is_recording(&file, &self.id) {
            return Ok(());
        }
        fs::remove_file(&file).map_err(|e| Failure::at(&file, "cannot be removed", &e))
    }

    /// Compares the recording with what the device has produced so far. After a sleep of the computer,
    /// what is still under way is recorded, too, and the rest is the shortfall.
    pub(crate) fn catch_up(&mut self, client: &mut Client<Line>) -> Result<Shortfall, Failure> {
        let mut shortfall = Shortfall::default();
        if !client.is_connected() || self.recorder.totals().received == 0 {
            return Ok(shortfall);
        }
        let Ok(status) = client.status() else {
            return Ok(shortfall);
        };
        let mut next_tick = self.recorder.next_tick();
        // Of a drive that has restarted it is less.
        if status.tick.saturating_sub(next_tick) <= UNDER_WAY_TICKS {
            return Ok(shortfall);
        }
        let mut blocks = Vec::new();
        let until = client.now() + CATCH_UP_TIMEOUT;
        let mut heard = client.now();
        while next_tick < status.tick {
            let now = client.now();
            if now >= until || now.saturating_sub(heard) >= CATCH_UP_SILENCE {
                break;
            }
            match client.pump(CATCH_UP_POLL) {
                Ok(Some(Event::Block(arrival))) => {
                    heard = client.now();
                    shortfall.samples += arrival.block.first_tick.saturating_sub(next_tick);
                    next_tick = next_tick.max(arrival.block.end_tick());
                    blocks.push(arrival.block);
                }
                Ok(Some(Event::Lost(_))) | Err(_) => break,
                Ok(_) => {}
            }
        }
        shortfall.samples += status.tick.saturating_sub(next_tick);
        if shortfall.samples <= UNDER_WAY_TICKS {
            // All of it is there: the recording ends where it was to end.
            return Ok(Shortfall::default());
        }
        shortfall.produced_to_tick = Some(status.tick);
        for block in blocks {
            self.block(client, &block)?;
        }
        Ok(shortfall)
    }

    /// Finishes the file; none if there is no sample, and then no file either.
    pub(crate) fn finish(self, ending: Ending) -> Result<Option<Totals>, Failure> {
        if self.recorder.totals().received == 0 {
            return self.discard().map(|()| None);
        }
        let file = self.recorder.path().to_owned();
        let totals = self.recorder.end(ending).map_err(stopped)?;
        in_final_format(&file, &self.id)?;
        Ok(Some(totals))
    }

    /// Leaves the file without an end: more was produced than is in it. Without a sample there is
    /// no file either.
    pub(crate) fn leave(mut self) -> Result<Option<Totals>, Failure> {
        if self.recorder.totals().received == 0 {
            return self.discard().map(|()| None);
        }
        self.recorder.flush().map_err(stopped)?;
        Ok(Some(self.recorder.totals()))
    }
}

/// Samples that are always under way, at most: 100 ms of them.
pub(crate) const UNDER_WAY_TICKS: u64 = 2_000;

/// Timeout of catching up with the device at the end of a recording.
const CATCH_UP_TIMEOUT: Duration = Duration::from_secs(2);

/// Silence that ends catching up.
const CATCH_UP_SILENCE: Duration = Duration::from_millis(250);

/// Timeout of a poll while catching up.
const CATCH_UP_POLL: Duration = Duration::from_millis(20);

/// Samples that are missing at the end of a recording.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shortfall {
    /// Their number.
    pub(crate) samples: u64,
    /// Tick up to which the device had produced samples, if the recording was behind it.
    pub(crate) produced_to_tick: Option<u64>,
}

/// There is no file to record into.
fn not_begun(error: RecordError) -> Failure {
    match error {
        RecordError::Disk {
            path,
            doing,
            source,
        } => Failure::at(&path, doing, &source),
        _ => Failure::input(error),
    }
}

/// A write error ends the recording.
#[expect(
    clippy::needless_pass_by_value,
    reason = "used where errors are mapped"
)]
fn stopped(error: RecordError) -> Failure {
    Failure::Work(format!(
        "{error}; the recording ends here, and `crepitus report` can read what was written"
    ))
}

impl Follower for Recorded {
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        if self.announced != Some(block.revision) {
            let (revision, values) = client.parameters().map_err(failure)?;
            self.recorder.announce(revision, &values);
            self.announced = Some(block.revision);
        }
        self.status.block(block);
        self.recorder.block(block).map_err(stopped)
    }

    fn resumed(&mut self, begin: Begin) -> Result<(), Failure> {
        // The device's parameters may be others, also with the same revision.
        self.announced = None;
        self.recorder.subscribed(begin).map_err(stopped)
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        self.recorder.flush().map_err(stopped)?;
        self.status.show(client.accounting());
        Ok(false)
    }
}

/// Extension of the files that this program leaves when a recording has ended.
pub(crate) fn extension() -> &'static str {
    if parquet_writer().is_some() {
        "parquet"
    } else {
        "crepitus"
    }
}

/// Replaces a finished recording by its Parquet file, if this program can. If
/// that fails, the recording stays as it is. It is an error if its file has been removed or replaced.
fn in_final_format(file: &Path, id: &str) -> Result<(), Failure> {
    let Some(writer) = parquet_writer() else {
        // The recording was written to the end, whatever its name is now.
        return fs::metadata(file)
            .map(|_| ())
            .map_err(|e| lost(&Failure::at(file, "cannot be read", &e).into_text()));
    };
    // What ended the recording must not end this; but it may be stopped, too.
    interrupt::forget();
    let recording =
        Recording::open(file, Damage::Refuse).map_err(|error| lost(&error.to_string()))?;
    if recording.metadata().id != id {
        let file = file.display();
        return Err(lost(&format!("{file} is another recording now")));
    }
    let made = replaced(recording, file, id, writer);
    if let Err(Failure::Input(error) | Failure::Work(error)) = made {
        warn(format!(
            "{error}; {} is whole, in the format of a recording in progress: `crepitus export {} \
             --format parquet` makes the Parquet file",
            file.display(),
            shell::word(file)
        ));
    }
    Ok(())
}

/// Replaces the file of this recording, and no other, by another format of it.
fn replaced(recording: Recording, file: &Path, id: &str, writer: Write) -> Result<(), Failure> {
    let failed = |error: io::Error| Failure::at(file, "cannot be written", &error);
    let new = temporary_in(folder_of(file)).map_err(failed)?;
    written(&recording, file, new.as_file(), writer)?;
    if !is_recording(file, id) {
        return Err(lost(&format!("{} is another file now", file.display())));
    }
    // Windows replaces no file that is open.
    drop(recording);
    new.persist(file).map_err(|error| failed(error.error))?;
    // The name, too, outlives a power cut.
    sync_folder_of(file).map_err(failed)
}

/// Failure: what was recorded is no longer in its file.
fn lost(why: &str) -> Failure {
    Failure::Work(format!(
        "{why}: the recording was moved, removed or changed while it ran; if it was moved, it is whole, in the \
         format of a recording in progress"
    ))
}

/// Writes a recording into an empty file, that will be called `out`. Returns its number of rows.
pub(crate) fn written(
    recording: &Recording,
    out: &Path,
    file: &File,
    write: Write,
) -> Result<u64, Failure> {
    let mut progress = Progress::of_reading();
    let expected = recording.accounting().totals.received.max(1);
    let rows = write(recording, file, &mut |rows| {
        #[expect(clippy::cast_precision_loss, reason = "a share")]
        progress.reached(rows as f64 / expected as f64);
        !interrupt::requested()
    });
    rows.map_err(|error| match error.kind() {
        ErrorKind::Interrupted => Failure::interrupted(),
        _ => Failure::at(out, "cannot be written", &error),
    })
}

/// Prints the sums of a recording, and what to do with it.
pub(crate) fn print_ended(file: &Path, totals: &Totals) -> Result<(), Failure> {
    print(&format!(
        "{}: {} samples produced = {} received + {} dropped\n\
         write its report with `{}`\n",
        file.display(),
        totals.produced,
        totals.received,
        totals.dropped,
        report_command(file)
    ))
}

/// The command that writes the report of a recording.
pub(crate) fn report_command(file: &Path) -> String {
    let command = format!("crepitus report {}", shell::word(file));
    // The folder's name is longer than the file's, which may have the greatest length already.
    let folder = fs::symlink_metadata(beside(file, "-report"));
    if folder.is_err_and(|error| error.kind() == ErrorKind::InvalidFilename) {
        command + " --out report"
    } else {
        command
    }
}

/// A file beside a recording: its whole name, and more.
pub(crate) fn beside(file: &Path, more: &str) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(more);
    PathBuf::from(name)
}

//! `crepitus record`: every sample to a file.

use crate::cli::{DeviceArguments, duration};
use crate::failure::{Failure, print, print_json};
use crate::following::{Follower, follow};
use crate::line::{Line, connect, failure};
use crate::status_line::StatusLine;
use clap::Args;
use crepitus_client::Client;
use crepitus_protocol::Revision;
use crepitus_protocol::telemetry::Block;
use crepitus_recording::{Recorder, Sidecar};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::time::{SystemTime, UNIX_EPOCH};

/// Record a device's samples to a file.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus record monday.csv --for 60s --arm
  crepitus record try.csv --device sim --for 5s --arm --title \"First try\"
  crepitus report monday.csv

Every sample of the drive, 20000 a second, goes to FILE; parameters, units and gaps go to a JSON \
file of the same name. A recording that was interrupted can still be reported. About 100 MB a \
minute.")]
pub(crate) struct Arguments {
    /// The CSV file; it must not exist.
    file: PathBuf,

    /// Duration: 500ms, 30s, 5m [default: until Ctrl-C].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    for_s: Option<Duration>,

    /// Arm first, and disarm at the end.
    #[arg(long)]
    arm: bool,

    /// Title of the recording.
    #[arg(long, default_value = "Recording of a device")]
    title: String,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Records.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut client = connect(&arguments.device)?;
    let mut recording = Recording::begin(&mut client, &arguments.file, &arguments.title)?;
    client.subscribe().map_err(failure)?;
    let end = follow(&mut client, arguments.for_s, arguments.arm, &mut recording);
    // Finishes the files also after an error.
    let sidecar = recording.finish()?;
    end?;
    let t = sidecar.telemetry;
    if as_json {
        return print_json(&json!({
            "file": arguments.file,
            "telemetry": t,
            "drive_restarts": sidecar.drive_restarts,
        }));
    }
    print(&format!(
        "{}: {} samples produced = {} received + {} dropped\n\
         write its report with `crepitus report {}`\n",
        arguments.file.display(),
        t.produced,
        t.received,
        t.dropped,
        arguments.file.display()
    ))
}

/// A recording in progress.
pub(crate) struct Recording {
    recorder: Recorder,
    announced: Option<Revision>,
    status: StatusLine,
}

impl Recording {
    /// Creates the files.
    pub(crate) fn begin(
        client: &mut Client<Line>,
        file: &Path,
        title: &str,
    ) -> Result<Self, Failure> {
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |since| since.as_secs());
        let handshake = client.handshake();
        let sidecar = Sidecar::new(title, now, &handshake.comms, handshake.drive.as_ref());
        Ok(Self {
            recorder: Recorder::create(file, sidecar).map_err(Failure::input)?,
            announced: None,
            status: StatusLine::new(),
        })
    }

    /// Finishes the files.
    pub(crate) fn finish(self) -> Result<Sidecar, Failure> {
        self.recorder.finish().map_err(stopped)
    }
}

/// A write error ends the recording.
#[expect(
    clippy::needless_pass_by_value,
    reason = "used where errors are mapped"
)]
fn stopped(error: crepitus_recording::RecordError) -> Failure {
    Failure::Work(format!(
        "{error}; the recording ends here, and `crepitus report` can read what was written"
    ))
}

impl Follower for Recording {
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        if self.announced != Some(block.revision) {
            let (revision, values) = client.parameters().map_err(failure)?;
            self.recorder.announce(revision, &values);
            self.announced = Some(block.revision);
        }
        self.status.block(block);
        self.recorder.block(block).map_err(stopped)
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        self.recorder.flush().map_err(stopped)?;
        self.status.show(client.accounting());
        Ok(false)
    }
}

//! `crepitus record`: every sample to a file.

use crate::cli::{Arming, DeviceArguments, duration};
use crate::failure::{Failure, print, print_json};
use crate::following::{End, follow};
use crate::interrupt;
use crate::line::{Line, connect_to_arm};
use crate::recorded::{Recorded, Shortfall, UNDER_WAY_TICKS, print_ended, report_command};
use clap::Args;
use crepitus_client::connection::device_text;
use crepitus_client::{Client, Unheard};
use crepitus_files::json_path;
use crepitus_files::output::{Inputs, NewFile, OutputError, is_stdout};
use crepitus_protocol::State;
use crepitus_recording::{EndCause, Ending, Totals, seconds};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Record a device's samples to a file.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus record monday.parquet --for 60s --arm
  crepitus record try --device sim --for 5s --arm --zero --title \"First try\"
  crepitus report monday.parquet
  crepitus export monday.parquet --format csv

Every sample of the drive, 20000 a second, goes to FILE, with the parameters, the devices, and the \
accounting of what is missing. While recording, FILE can be read whatever happens to this program: \
`report` says first what is missing. When the recording has ended, FILE becomes a Parquet file, which \
pandas, polars and DuckDB read, if this program was built with `--features parquet`. About 23 MB a \
minute while recording, 6 MB in the end.")]
pub(crate) struct Arguments {
    /// The file, with any name; it must not exist.
    file: PathBuf,

    /// Duration: 500ms, 30s, 5m [default: until Ctrl-C].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    for_s: Option<Duration>,

    #[command(flatten)]
    arming: Arming,

    /// Title of the recording.
    #[arg(long, default_value = "Recording of a device")]
    title: String,

    #[command(flatten)]
    device: DeviceArguments,
}

/// A fault or a lost device ends a recording, and what came before is in the file.
fn kept(failure: Failure, file: &Path, totals: &Totals) -> Failure {
    let Failure::Work(text) = failure else {
        return failure;
    };
    let text = format!(
        "{text}; {} holds {} samples: `{}`",
        file.display(),
        totals.received,
        report_command(file)
    );
    let fields = [
        ("file", json!(json_path(file))),
        ("telemetry", json!(totals)),
    ];
    let fields = fields.map(|(name, value)| (name.to_owned(), value));
    Failure::Kept(text, fields.into_iter().collect())
}

/// The end of the recording is not what the device had produced by then.
fn silent(unheard: Unheard) -> Failure {
    let ms = unheard.silence.as_millis();
    let what = match unheard.samples {
        Some(samples) => format!("while the device has produced {samples} samples"),
        None => "and the device does not answer".to_owned(),
    };
    Failure::Work(format!(
        "nothing was heard for the last {ms} ms, {what}: the recording is not complete"
    ))
}

/// The device produced samples that this program did not read in time.
fn asleep(samples: u64) -> Failure {
    Failure::Work(format!(
        "{samples} samples ({:.3} s) are missing at the end of the recording: the device had produced them, and \
         this program did not receive them; did the computer sleep, or was the program stopped?",
        seconds(samples)
    ))
}

/// The end of the recording, for its file.
fn ending(client: &mut Client<Line>, end: &Result<End, Failure>, shortfall: Shortfall) -> Ending {
    let status = if client.is_connected() {
        client.status().ok()
    } else {
        None
    };
    let faults = status.map_or_else(Vec::new, |status| device_text::faults(&status));
    let cause = match end {
        Ok(End::Time) => EndCause::Time,
        Ok(End::Requested) => EndCause::Requested,
        Err(_) if !faults.is_empty() => EndCause::Fault,
        Err(_) => match status {
            None => EndCause::ConnectionLost,
            Some(status) if status.state == State::Disarmed => EndCause::Disarmed,
            Some(_) => EndCause::Error,
        },
    };
    Ending {
        cause,
        faults,
        produced_to_tick: shortfall.produced_to_tick,
    }
}

/// Records.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    interrupt::listen();
    if arguments.for_s.is_some_and(|time| time.is_zero()) {
        return Err(Failure::input("--for: expected a time above 0, got 0"));
    }
    let file = &arguments.file;
    if is_stdout(file) {
        return Err(Failure::Input(format!(
            "{}: a recording is a file, not standard output: name one, or print samples with `crepitus stream`",
            file.display()
        )));
    }
    // Before the device is looked for.
    NewFile::create(file, false, &Inputs::default()).map_err(|error| match error {
        OutputError::Exists { .. } => {
            Failure::Input(format!("{error}: choose another name, or remove it"))
        }
        error => error.into(),
    })?;
    let mut client = connect_to_arm(&arguments.device, arguments.arming)?;
    let mut recorded = Recorded::begin(&mut client, file, &arguments.title)?;
    let end = follow(
        &mut client,
        arguments.for_s,
        arguments.arming,
        &mut recorded,
    );
    let shortfall = recorded.catch_up(&mut client)?;
    let ending = ending(&mut client, &end, shortfall);
    let unheard = client.unheard();
    client.end_telemetry();
    if let (Ok(_), Some(unheard)) = (&end, unheard) {
        let failure = silent(unheard);
        return Err(match recorded.leave()? {
            Some(totals) => kept(failure, file, &totals),
            None => failure,
        });
    }
    // Finishes the file also after an error.
    let totals = recorded.finish(ending)?;
    if let Err(failure) = end {
        return Err(match totals {
            Some(totals) => kept(failure, file, &totals),
            None => failure,
        });
    }
    if let Some(totals) = totals
        && shortfall.samples > UNDER_WAY_TICKS
    {
        return Err(kept(asleep(shortfall.samples), file, &totals));
    }
    match totals {
        None if as_json => print_json(&json!({ "file": null })),
        None => print("no sample came: nothing was recorded\n"),
        Some(totals) if as_json => {
            print_json(&json!({ "file": json_path(file), "telemetry": totals }))
        }
        Some(totals) => print_ended(file, &totals),
    }
}

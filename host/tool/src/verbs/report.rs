//! `crepitus report FILE`: the report of a recording.

use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::recorded::{RecordedSummary, report as write_report};
use clap::Args;
use crepitus_recording::Recording;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Make the report of a recording.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus report out/demo/recording.csv
  crepitus report monday.csv --out monday-report --pictures")]
pub(crate) struct Arguments {
    /// The recording: its CSV file.
    file: PathBuf,

    /// Folder for report.html and summary.json [default: FILE without its ending].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Write each figure of the report as an SVG file of its own, too.
    #[arg(long)]
    pictures: bool,
}

/// Reports.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let recording = Recording::open(&arguments.file).map_err(Failure::input)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| arguments.file.with_extension(""));
    interrupt::listen();
    let summary = write_report(&recording, &out, arguments.pictures)?;
    if as_json {
        return print_json(&json!({ "out": out, "summary": summary }));
    }
    print(&in_brief(&summary, &out))
}

/// A few lines.
pub(crate) fn in_brief(s: &RecordedSummary, out: &Path) -> String {
    let warnings = s.warnings.iter().fold(String::new(), |text, warning| {
        text + "  note: " + warning + "\n"
    });
    let torque = s.model_torque.map_or(String::new(), |t| {
        format!(
            "  torque of the model {:.3} to {:.3} N·m, mean {:.3}\n",
            t.min_nm, t.max_nm, t.mean_nm
        )
    });
    format!(
        "{}\n  {:.3} s, {:.3} s of it armed, with {} breaks and {} sticks\n{torque}  \
         {} samples produced = {} received + {} dropped\n{warnings}report: {}\n",
        s.title,
        s.duration_s,
        s.armed_s,
        s.breaks,
        s.sticks,
        s.telemetry.produced,
        s.telemetry.received,
        s.telemetry.dropped,
        out.join("report.html").display()
    )
}

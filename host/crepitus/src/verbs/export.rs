//! `crepitus export`: a recording in another format.

use crate::cli::Force;
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::output::to_stderr;
use crate::recorded::{beside, written};
use clap::{Args, ValueEnum};
use crepitus_files::json_path;
use crepitus_files::output::{Inputs, NewFile};
use crepitus_recording::{COLUMNS, Damage, Recording, Write, mcap_writer, parquet_writer};
use serde_json::json;
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write as _};
use std::path::PathBuf;

/// Formats of exported files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ExportFormat {
    /// A header, and one line a sample.
    Csv,
    /// For Foxglove: 1 kHz, events and parameters.
    Mcap,
    /// One file with everything, for pandas, polars, DuckDB.
    Parquet,
}

impl ExportFormat {
    fn extension(self) -> &'static str {
        match self {
            Self::Csv => ".csv",
            Self::Mcap => ".mcap",
            Self::Parquet => ".parquet",
        }
    }

    /// Writer of the format; none if this program was built without it.
    fn writer(self) -> Option<Write> {
        match self {
            Self::Csv => Some(csv),
            Self::Mcap => mcap_writer(),
            Self::Parquet => parquet_writer(),
        }
    }
}

/// Write a recording in another format.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus export monday.parquet --format csv
  crepitus export monday.parquet --format mcap --out monday.mcap
  crepitus export interrupted --format parquet
  crepitus export damaged --format parquet --salvage

FILE stays as it is. csv has every sample, without parameters and devices; mcap a message a \
millisecond, every break and stick, the parameters and the gaps, for Foxglove; parquet everything: \
also of a recording that was interrupted. mcap and parquet need a program that was built with \
`--features mcap` and `--features parquet`.")]
pub(crate) struct Arguments {
    /// The recording.
    file: PathBuf,

    /// Format of the new file.
    #[arg(long)]
    format: ExportFormat,

    /// The new file; `-` is standard output [default: FILE with .csv, .mcap or .parquet appended].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    /// Keep what is readable of a damaged recording.
    #[arg(long)]
    salvage: bool,
}

/// Exports.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let format = arguments.format;
    let name = &format.extension()[1..];
    let writer = format.writer().ok_or_else(|| {
        Failure::Input(format!(
            "this crepitus was built without that format: build it with `--features {name}`"
        ))
    })?;
    let damage = if arguments.salvage {
        Damage::Salvage
    } else {
        Damage::Refuse
    };
    let out =
        (arguments.out.clone()).unwrap_or_else(|| beside(&arguments.file, format.extension()));
    let inputs = Inputs::of([&arguments.file]);
    let new = NewFile::create(&out, arguments.force.force, &inputs)?;
    let on_stdout = new.is_stdout();
    if on_stdout && as_json {
        return Err(Failure::input(
            "--json and --out - would both write to standard output: name a file with --out",
        ));
    }
    let recording = Recording::open(&arguments.file, damage).map_err(Failure::input)?;
    let warnings = recording.warnings();
    if !as_json {
        warnings.iter().for_each(warn);
    }
    interrupt::listen();
    let rows = written(&recording, &out, new.as_file(), writer)?;
    new.persist()?;
    let totals = recording.accounting().totals;
    if as_json {
        return print_json(
            &json!({ "out": json_path(&out), "rows": rows, "telemetry": totals, "warnings": warnings }),
        );
    }
    let what = match format {
        ExportFormat::Mcap => "rows, one a millisecond",
        ExportFormat::Csv | ExportFormat::Parquet => "samples",
    };
    let text = format!("{}: {rows} {what}", out.display());
    if on_stdout {
        to_stderr(&text);
        return Ok(());
    }
    print(&(text + "\n"))
}

/// Rows between two updates of the progress.
const PROGRESS_ROWS: u64 = 1 << 14;

fn csv(
    recording: &Recording,
    file: &File,
    progress: &mut dyn FnMut(u64) -> bool,
) -> io::Result<u64> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    let header: Vec<_> = COLUMNS.iter().map(|column| column.name).collect();
    let mut line = header.join(",") + "\n";
    let mut rows = 0;
    for (count, row) in (0_u64..).zip(recording.rows().map_err(io::Error::other)?) {
        row.map_err(io::Error::other)?.append_to(&mut line);
        out.write_all(line.as_bytes())?;
        line.clear();
        rows = count + 1;
        if count.is_multiple_of(PROGRESS_ROWS) && !progress(count) {
            return Err(ErrorKind::Interrupted.into());
        }
    }
    out.write_all(line.as_bytes())?;
    out.flush()?;
    file.sync_all()?;
    Ok(rows)
}

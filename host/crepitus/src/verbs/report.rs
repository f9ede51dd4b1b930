//! `crepitus report FILE`: the report of a recording.

mod tables;

use crate::cli::Force;
use crate::failure::{Failure, print_json};
use crate::interrupt;
use crate::overlay::{self, Overlay};
use crate::pictures::Pictures;
use crate::progress::Progress;
use crate::recorded::beside;
use crate::reported::Reported;
use crate::results::{self, REPORT, report_files};
use crate::sections::{counts, torque_levels};
use crate::wav::Wav;
use clap::Args;
use crepitus_files::output::{Folder, Inputs};
use crepitus_pages::recorded::{Analysis, RecordingSummary, ReportColumns};
use crepitus_pages::report::{Collector, Mark, Setup, Text, TorqueLevels};
use crepitus_pages::words::footer;
use crepitus_protocol::TICK_S;
use crepitus_recording::{
    ArmingPushes, Damage, History, Recording, Row, SampleAccounting, Step, seconds,
};
use std::path::{Path, PathBuf};

/// Rows between two updates of the progress.
const PROGRESS_ROWS: u64 = 1 << 14;

/// Write the report of a recording.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus report monday.parquet
  crepitus report monday.parquet --out monday-report --pictures
  crepitus report monday.parquet --overlay bench.csv \\
      --overlay-columns t_s=time,torque_nm=T
  crepitus report monday.parquet --wav monday.wav
  crepitus report damaged --salvage

What is missing is said first. A recording that was interrupted is reported up to where it ends; a \
damaged one is refused, or, with --salvage, reported as far as it can be read.")]
pub(crate) struct Arguments {
    /// The recording.
    file: PathBuf,

    /// Folder for report.html and summary.json [default: FILE-report].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Report what is readable of a damaged recording.
    #[arg(long)]
    salvage: bool,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,

    #[command(flatten)]
    overlay: Overlay,

    #[command(flatten)]
    wav: Wav,
}

/// Options of a report: pictures, measured curves, a sound.
#[derive(Debug)]
pub(super) struct Extras<'a> {
    pub(super) pictures: &'a Pictures,
    pub(super) overlay: &'a Overlay,
    pub(super) wav: &'a Wav,
    pub(super) force: Force,
}

/// Writes the report of a recording.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let damage = if arguments.salvage {
        Damage::Salvage
    } else {
        Damage::Refuse
    };
    let recording = Recording::open(&arguments.file, damage).map_err(Failure::input)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| beside(&arguments.file, "-report"));
    interrupt::listen();
    let extras = Extras {
        pictures: &arguments.pictures,
        overlay: &arguments.overlay,
        wav: &arguments.wav,
        force: arguments.force,
    };
    arguments.wav.check_stdout(as_json)?;
    let reported = write(&arguments.file, &recording, &out, &extras)?;
    if as_json {
        return print_json(&reported.json(&out));
    }
    arguments.wav.print(&text(&reported, &out))
}

/// Writes `report.html` and `summary.json` of a recording into `out`.
pub(super) fn write(
    file: &Path,
    recording: &Recording,
    out: &Path,
    extras: &Extras<'_>,
) -> Result<Reported<RecordingSummary>, Failure> {
    // The report of another recording is not replaced.
    let verb = format!("report {}", recording.metadata().id);
    let inputs = [Some(file), extras.overlay.file()].into_iter().flatten();
    let claim = extras.force.claim(&verb, inputs);
    let protected = claim.inputs.clone();
    let folder = results::folder(out, claim, REPORT)?;
    write_into(folder, recording, out, extras, &protected)
}

/// Writes the report by way of a folder that is prepared, with what it has already.
pub(super) fn write_into(
    folder: Folder,
    recording: &Recording,
    out: &Path,
    extras: &Extras<'_>,
    inputs: &Inputs,
) -> Result<Reported<RecordingSummary>, Failure> {
    let parameters = recording.parameters();
    let report_columns = ReportColumns::of(parameters);
    let columns = report_columns.columns();
    let measured = extras.overlay.read(&columns)?;
    let mut listener = extras
        .wav
        .listener(&columns, TICK_S, extras.force, inputs)?;
    let expected = recording.accounting().totals.received;
    let setup = Setup {
        columns: &columns,
        rows_expected: expected,
        row_step_s: TICK_S,
        levels: levels(parameters),
        effects: report_columns.settings(),
    };
    let mut collector = Collector::new(&setup);
    collector.may_lack_from(report_columns.certain());
    collector.compare(measured, &columns);
    let mut changes = parameters.changes().peekable();
    let mut changed_at_s = Vec::new();
    let mut before: Option<Row> = None;
    let mut values = Vec::new();
    let mut pushes = ArmingPushes::default();
    let mut analysis = Analysis::new(recording);
    let mut progress = Progress::of_reading();
    for (n, row) in (0_u64..).zip(recording.rows().map_err(Failure::input)?) {
        let row = row.map_err(Failure::input)?;
        while let Some((_, name)) = changes.next_if(|(first_row, _)| *first_row <= n) {
            if n > 0 {
                let at = row.time_s;
                collector.mark(Mark { at, name });
            }
            changed_at_s.push(row.time_s);
        }
        note_step(
            &mut collector,
            before.as_ref(),
            &row,
            recording.accounting(),
        );
        before = Some(row);
        let derived = analysis.row(&row);
        report_columns.read(&row, &derived, analysis.values(), &mut values);
        collector.row(&values);
        if let Some(listener) = &mut listener {
            listener.row(&values)?;
        }
        if let Some(event) = derived.event {
            collector.event(&event);
        }
        if let Some((from_s, to_s)) = pushes.row(&row) {
            collector.arming_push(from_s, to_s);
        }
        if n.is_multiple_of(PROGRESS_ROWS) {
            #[expect(clippy::cast_precision_loss, reason = "a share")]
            progress.reached(n as f64 / expected.max(1) as f64);
            if interrupt::requested() {
                return Err(Failure::interrupted());
            }
        }
    }
    let missing_s = seconds(recording.accounting().missing_at_end);
    if missing_s > 0.0 {
        let last_s = before.map_or(0.0, |row| row.time_s);
        collector.gap(last_s, last_s + missing_s);
    }
    let summary = analysis.finish();
    let text = Text {
        title: recording.metadata().title.clone(),
        description: Some(tables::first_sentences(&summary)),
        warnings: summary.warnings.clone(),
        sections: tables::sections(&summary, recording.accounting(), &changed_at_s),
        footer: footer(),
    };
    let figures = collector.finish();
    let page = crepitus_pages::report::html(&text, &figures);
    let pictures = extras
        .pictures
        .files(|paper| crepitus_pages::report::pictures(&figures, paper))?;
    let files = report_files(page, &summary, pictures)?;
    results::write(folder, out, files)?;
    let sound = listener
        .map(|listener| listener.finish(&text.title))
        .transpose()?;
    let differences = figures.differences();
    overlay::warn_of_nothing(&differences, extras.overlay.file());
    Ok(Reported {
        summary,
        differences,
        sound,
    })
}

/// Tells the figures what lies before a row: missing samples, or a restart of the drive.
fn note_step(
    collector: &mut Collector,
    before: Option<&Row>,
    row: &Row,
    accounting: &SampleAccounting,
) {
    let Some(before) = before else {
        let from_s = first_time_s(row, accounting);
        if row.time_s - from_s > 0.5 * TICK_S {
            collector.gap(from_s, row.time_s);
        }
        return;
    };
    match row.step_from(before) {
        Step::Next => {}
        Step::Missing(_) => collector.gap(before.time_s, row.time_s),
        Step::Restart => {
            collector.gap(before.time_s, row.time_s);
            collector.mark(Mark {
                at: row.time_s,
                name: "drive restarted".to_owned(),
            });
        }
    }
}

/// Start of the accounting, s: before the first row, if samples are missing there.
fn first_time_s(first: &Row, accounting: &SampleAccounting) -> f64 {
    let gaps = accounting.gaps.iter().take_while(|gap| gap.row == 0);
    let missing = gaps.map(|gap| gap.samples).sum();
    (first.time_s - seconds(missing)).min(0.0)
}

/// The torque levels, if crepitus was on with the same ones all the time.
fn levels(parameters: &History) -> Option<TorqueLevels> {
    let mut in_force = parameters.in_force();
    let mut sets = parameters.0.iter().map(|set| {
        in_force.at(set.first_row);
        Some(torque_levels(&in_force.joint_settings()?))
    });
    let first = sets.next()??;
    sets.all(|other| other == Some(first)).then_some(first)
}

/// The printed text of a report, for people.
pub(super) fn text(reported: &Reported<RecordingSummary>, out: &Path) -> String {
    let brief = in_brief(&reported.summary);
    reported.text(&brief, "report", &out.join("report.html"))
}

/// The summary in a few lines.
fn in_brief(s: &RecordingSummary) -> String {
    let warnings = s.warnings.iter().fold(String::new(), |text, warning| {
        text + "  note: " + warning + "\n"
    });
    let torque = s.model_torque.map_or(String::new(), |t| {
        format!(
            "  torque of the model {:.3} to {:.3} N·m, mean {:.3}\n",
            t.min_nm, t.max_nm, t.mean_nm
        )
    });
    let within = if s.span_s - s.duration_s > TICK_S {
        format!(" within {:.3} s", s.span_s)
    } else {
        String::new()
    };
    format!(
        "{}\n{warnings}  {:.3} s recorded{within}, {:.3} s of it armed, with {}\n{torque}  \
         {} samples produced = {} received + {} dropped\n",
        s.title,
        s.duration_s,
        s.armed_s,
        counts(&[(s.breaks, "break"), (s.sticks, "stick")]),
        s.telemetry.produced,
        s.telemetry.received,
        s.telemetry.dropped
    )
}

#[cfg(test)]
mod tests;

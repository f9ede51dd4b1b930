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
use crate::results::{self, REPORT, footer, report_files};
use crate::sections::{counts, torque_levels};
use crate::wav::Wav;
use clap::Args;
use crepitus_files::output::{Folder, Inputs};
use crepitus_pages::recorded::{Analysis, RecordingSummary, ReportColumns};
use crepitus_pages::report::{Collector, Mark, Setup, Text, TorqueLevels};
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
    collector.may_lack_from(ReportColumns::ALWAYS);
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
fn note_step(collector: &mut Collector, before: Option<&Row>, row: &Row, books: &SampleAccounting) {
    let Some(before) = before else {
        let from_s = first_time_s(row, books);
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
fn first_time_s(first: &Row, books: &SampleAccounting) -> f64 {
    let gaps = books.gaps.iter().take_while(|gap| gap.row == 0);
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
mod tests {
    use super::*;
    use clap::Parser;
    use crepitus_model::render::effects::Phases;
    use crepitus_protocol::management::Identity;
    use crepitus_protocol::parameters::{find, id};
    use crepitus_protocol::telemetry::{Block, BlockFlags};
    use crepitus_protocol::{Revision, State, Values};
    use crepitus_recording::{Begin, Metadata, Recorder};
    use std::ffi::OsStr;
    use std::fs;

    /// The command line of a report.
    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    /// The page of a recording: runs of blocks, each with its first tick, the drive's start and the
    /// number of blocks. The accounting begins at tick 1,000.
    fn page(runs: &[(u64, u16, u64)]) -> String {
        let blocks = runs.iter().flat_map(|(first_tick, start, blocks)| {
            (0..*blocks).map(move |n| block(first_tick + 20 * n, *start))
        });
        page_of(&Values::default(), blocks)
    }

    /// The page of a recording of these blocks under these parameters.
    fn page_of(values: &Values, blocks: impl Iterator<Item = Block>) -> String {
        page_under(&[(Block::default().revision, *values)], blocks)
    }

    /// The page of a recording of these blocks, each under the parameters of its revision.
    fn page_under(revisions: &[(Revision, Values)], blocks: impl Iterator<Item = Block>) -> String {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        let metadata = Metadata::new("a test", &Identity::default(), None);
        let mut recorder = Recorder::create(&file, &metadata).unwrap();
        let begin = Begin {
            first_tick: 1_000,
            dropped: 0,
            start: 1,
        };
        recorder.subscribed(begin).unwrap();
        for (revision, values) in revisions {
            recorder.announce(*revision, values);
        }
        for block in blocks {
            recorder.block(&block).unwrap();
        }
        recorder.finish().unwrap();
        let line = Line::parse_from([OsStr::new("report"), file.as_os_str()]);
        let extras = Extras {
            pictures: &line.arguments.pictures,
            overlay: &line.arguments.overlay,
            wav: &line.arguments.wav,
            force: Force::default(),
        };
        let out = folder.path().join("out");
        let recording = Recording::open(&file, Damage::Refuse).unwrap();
        write(&file, &recording, &out, &extras).unwrap();
        fs::read_to_string(out.join("report.html")).unwrap()
    }

    /// A count a tick, and a torque that is not zero throughout.
    fn block(first_tick: u64, start: u16) -> Block {
        let mut block = Block {
            first_tick,
            flags: BlockFlags::new(State::Disarmed, false, start),
            ..Block::default()
        };
        for (sample, tick) in block.samples.iter_mut().zip(first_tick..) {
            sample.count = i32::try_from(tick).unwrap();
            sample.model_torque_nm = 0.01 * f32::from(u8::try_from(tick % 50).unwrap());
        }
        block
    }

    /// Clonus: twenty beats, twenty a second, after a tenth of a second at rest.
    fn beating(first_tick: u64) -> Block {
        let mut block = Block {
            first_tick,
            flags: BlockFlags::new(State::Armed, true, 1),
            ..Block::default()
        };
        let samples = block.samples.iter_mut().zip(&mut block.phases);
        for ((sample, phases), tick) in samples.zip(first_tick - 1_000..) {
            let since = tick.checked_sub(2_000);
            let (name, nm) = match since.map(|since| (since / 1_000, since % 1_000)) {
                None => ("ready", 0.0),
                Some((1..=20, since)) if since < 450 => {
                    let share = f32::from(u16::try_from(since).unwrap()) / 450.0;
                    ("beating", 1.5 * (std::f32::consts::PI * share).sin())
                }
                Some((0..=20, _)) => ("beating", 0.0),
                Some(_) => ("over", 0.0),
            };
            sample.count = i32::try_from(tick).unwrap();
            sample.model_torque_nm = nm;
            *phases = Phases::default().with_named("clonus", name).unwrap().into();
        }
        block
    }

    #[test]
    fn a_recording_of_clonus_alone_has_its_beats_and_nothing_of_crepitus() {
        let mut values = Values::default();
        values.set(find("clonus.render").unwrap().0, 1.0);
        let blocks = || (0..1_300).map(|n| beating(1_000 + 20 * n));
        let beats = "20 beats in 1.0 s, ended by itself";
        let shared = "of everything that was rendered together";
        // With crepitus nobody knows whose torque it is.
        let both = page_of(&values, blocks());
        assert!(both.contains("beats that cannot be told apart") && both.contains(shared));
        assert!(both.contains("Ts") && both.contains("broke loose"));
        values.set(id::CREPITUS, 0.0);
        let alone = page_of(&values, blocks());
        let felt = "with the motor on, the knee's torque went from 0 to 1.5 N·m";
        for part in [beats, "Beats of clonus", "Torque of model and motor", felt] {
            assert!(alone.contains(part), "{part}");
        }
        for part in ["Ts", "broke loose", "imaginary object", "rendered together"] {
            assert!(!alone.contains(part), "{part}");
        }
    }

    /// The object slips while crepitus is on, and has no phase after: the sample's flags have that
    /// of a stick then, which is 0.
    #[test]
    fn no_stick_is_shaded_while_crepitus_is_off() {
        let on = Values::default();
        let mut off = on;
        off.set(id::CREPITUS, 0.0);
        let [first, second] = [Revision(1), Revision(2)];
        let blocks = || {
            (0..200).map(move |n| {
                let mut block = block(1_000 + 20 * n, 1);
                block.revision = if n < 100 { first } else { second };
                for sample in &mut block.samples {
                    let sign = i8::from(n < 100);
                    sample.flags = sample.flags.with_phase(sign);
                }
                block
            })
        };
        let is_shaded = |page: &str, phase: &str| page.contains(&format!("</span>{phase}</li>"));
        let page = page_under(&[(first, on), (second, off)], blocks());
        assert!(is_shaded(&page, "slip +") && !is_shaded(&page, "stick"));
        let always_on = page_under(&[(first, on), (second, on)], blocks());
        assert!(is_shaded(&always_on, "slip +") && is_shaded(&always_on, "stick"));
    }

    const BLANK: &str = "Blank between dotted lines";

    /// The name above a chart.
    const RESTARTED: &str = ">drive restarted<";

    #[test]
    fn a_recording_without_a_gap_has_none_drawn() {
        let page = page(&[(1_000, 1, 200)]);
        assert!(!page.contains(BLANK) && !page.contains(RESTARTED));
        // The first sentences.
        let first = "In 0.2 s with the motor on, the knee's torque went from 0 to 0.49 N·m, with the leg at \
                     up to 41 °/s. All 4000 samples are here.";
        let said = page
            .split("class=\"description\">")
            .nth(1)
            .unwrap_or_default();
        assert!(said.starts_with(first), "{said:.120}");
    }

    #[test]
    fn no_line_reaches_across_a_restart_of_the_drive() {
        // The drive's ticks begin again, at 0.
        let page = page(&[(1_000, 1, 200), (0, 2, 200)]);
        assert!(page.contains(BLANK) && page.contains(RESTARTED));
        assert!(page.contains("The drive restarted once"));
    }

    #[test]
    fn samples_missing_before_the_first_one_are_drawn() {
        let page = page(&[(3_000, 1, 200)]);
        assert!(page.contains("2000 samples, 0.1000 s: lost on the way"));
        assert!(page.contains("2000 of 6000 samples are missing."));
        assert!(page.contains(BLANK) && !page.contains(RESTARTED));
    }

    #[test]
    fn the_accounting_begins_before_the_first_row_by_what_is_missing_there() {
        let gap = |row, samples| crepitus_recording::Gap {
            row,
            first_tick: 0,
            samples,
            cause: crepitus_recording::Cause::OnTheWay,
        };
        let books = SampleAccounting {
            gaps: vec![gap(0, 1_000), gap(0, 3_000), gap(20, 500)],
            ..SampleAccounting::default()
        };
        let first_s = |time_s: f64, books: &SampleAccounting| {
            let row = Row {
                time_s,
                ..Row::default()
            };
            first_time_s(&row, books)
        };
        assert!((first_s(0.0, &books) + 0.2).abs() < 1e-12);
        // Of a file whose first rows are lost.
        assert_eq!(first_s(0.2, &books), 0.0);
        assert_eq!(first_s(2.0, &SampleAccounting::default()), 0.0);
        assert_eq!(first_s(0.0, &SampleAccounting::default()), 0.0);
    }

    #[test]
    fn span_and_recorded_time_differ_by_what_is_missing() {
        let page = page(&[(1_000, 1, 200), (9_000, 1, 200)]);
        for part in ["recorded time", "0.400 s", "0.600 s from the first"] {
            assert!(page.contains(part), "{part}");
        }
    }
}

//! Pages of recordings that blocks were written into: beats, sticks, gaps, restarts.

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
    let accounting = SampleAccounting {
        gaps: vec![gap(0, 1_000), gap(0, 3_000), gap(20, 500)],
        ..SampleAccounting::default()
    };
    let first_s = |time_s: f64, accounting: &SampleAccounting| {
        let row = Row {
            time_s,
            ..Row::default()
        };
        first_time_s(&row, accounting)
    };
    assert!((first_s(0.0, &accounting) + 0.2).abs() < 1e-12);
    // Of a file whose first rows are lost.
    assert_eq!(first_s(0.2, &accounting), 0.0);
    assert_eq!(first_s(2.0, &SampleAccounting::default()), 0.0);
    assert_eq!(first_s(0.0, &SampleAccounting::default()), 0.0);
}

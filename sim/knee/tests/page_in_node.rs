//! The page's file in Node against the code of this build: every column of 20,000 ticks of every preset and
//! every symptom, and what the examination has measured of them, to the bit.
//!
//! The hand's targets come as those of a display, 30 to 120 times a second, so that path, leg and encoder are
//! compared, too. Without Node the test is left out, unless `CREPITUS_NEEDS_NODE` is set.

use crepitus_knee::examination::COUNT;
use crepitus_knee::page::Columns;
use crepitus_knee::{Page, pipeline};
use crepitus_model::render::effects::SYMPTOMS;
use crepitus_protocol::Values;
use crepitus_protocol::parameters::{find, id};
use crepitus_scene::preset;
use crepitus_scene::values::with_preset;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Set where a machine without Node is an error.
const NEEDED_VARIABLE: &str = "CREPITUS_NEEDS_NODE";

/// One second.
const TICKS: u32 = 20_000;

/// Ticks of the frames of an uneven display.
const FRAMES: [u32; 7] = [333, 250, 667, 167, 333, 500, 200];

/// Presets without torque: in an empty end-feel somebody says that it hurts.
const SILENT: [&str; 1] = ["end-feel-empty"];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Parameters by id, as a page sets them.
struct Knee {
    name: String,
    ids: Vec<u8>,
    values: Vec<f64>,
}

impl Knee {
    /// Values in which it differs from a healthy knee.
    fn of(name: &str, values: &Values) -> Self {
        let changes = values.iter().zip(pipeline::healthy().0);
        let (ids, values) = changes
            .filter(|((_, value), healthy)| value.to_bits() != healthy.to_bits())
            .map(|((parameter, value), _)| (parameter.id, value))
            .unzip();
        Self {
            name: name.to_owned(),
            ids,
            values,
        }
    }
}

/// Every preset, and every symptom alone at its defaults.
fn knees() -> Vec<Knee> {
    let mut knees: Vec<_> = preset::shipped()
        .iter()
        .map(|preset| {
            let values = with_preset(&pipeline::healthy(), preset, false);
            Knee::of(&preset.name, &values)
        })
        .collect();
    let mut add = |name: &str, id: u8| {
        let mut values = pipeline::healthy();
        values.set(id, 1.0);
        knees.push(Knee::of(name, &values));
    };
    add("crepitus", id::CREPITUS);
    for (spec, _) in SYMPTOMS {
        let (id, _) = find(&format!("{}.render", spec.name)).unwrap();
        add(spec.name, id);
    }
    knees
}

/// A hand that bends the knee to 120° and back, and is straight from 0.8 s to the end: the ticks of each frame, and
/// its target, rad.
fn motion() -> Vec<(u32, f32)> {
    let mut begun = 0;
    let mut frames = Vec::new();
    for frame in FRAMES.into_iter().cycle() {
        let ticks = frame.min(TICKS - begun);
        let turns = (f64::from(begun) / (0.8 * f64::from(TICKS))).min(1.0);
        let deg = 60.0 * (1.0 - (std::f64::consts::TAU * turns).cos());
        #[expect(clippy::cast_possible_truncation, reason = "as a page has it")]
        frames.push((ticks, deg.to_radians() as f32));
        begun += ticks;
        if begun == TICKS {
            break;
        }
    }
    frames
}

/// The columns of so many samples as bytes, in the order of the script.
fn bytes(columns: &Columns, count: usize) -> Vec<[u8; 4]> {
    let floats = [
        &columns.torque_nm,
        &columns.angle_rad,
        &columns.speed_rad_s,
        &columns.hand_rad,
        &columns.object_rad,
        &columns.spring_nm,
    ];
    let words = [&columns.states, &columns.phase];
    let floats = floats.into_iter().flat_map(|c| &c[..count]);
    let words = words.into_iter().flat_map(|c| &c[..count]);
    floats
        .map(|number| number.to_le_bytes())
        .chain(words.map(|word| word.to_le_bytes()))
        .collect()
}

/// Columns of Node; none without it.
fn in_node(knees: &[Knee], motion: &[(u32, f32)]) -> Option<Vec<u8>> {
    let page = repository().join("host/panel/assets/knee.wasm");
    let node = Command::new("node")
        .arg(repository().join("tools/knee-page/columns.mjs"))
        .arg(&page)
        .arg(COUNT.to_string())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let Ok(mut node) = node else {
        let needed = std::env::var_os(NEEDED_VARIABLE).is_some();
        assert!(!needed, "{NEEDED_VARIABLE} is set, and there is no node");
        eprintln!("left out: there is no node");
        return None;
    };
    let ticks: Vec<_> = motion.iter().map(|(ticks, _)| ticks).collect();
    let angles: Vec<_> = motion.iter().map(|(_, angle)| f64::from(*angle)).collect();
    let mut lines = String::new();
    for Knee { ids, values, .. } in knees {
        writeln!(lines, "[{ids:?},{values:?},{ticks:?},{angles:?}]").unwrap();
    }
    let mut stdin = node.stdin.take().unwrap();
    // The script reads all of it before it writes. One that has ended does not read: its status shows it.
    let _ = stdin.write_all(lines.as_bytes());
    drop(stdin);
    let output = node.wait_with_output().unwrap();
    assert!(
        output.status.success(),
        "no columns of {}, which `cargo run -p crepitus-tools --bin crepitus-knee-page` builds",
        page.display()
    );
    Some(output.stdout)
}

/// Compares measures, steps and findings with those of Node; returns what is behind them.
fn examined<'t>(name: &str, page: &Page, theirs: &'t [[u8; 4]]) -> &'t [[u8; 4]] {
    let same = |ours: &[f32], theirs: &[[u8; 4]]| {
        for (ours, word) in ours.iter().zip(theirs) {
            let theirs = f32::from_le_bytes(*word);
            // Every NaN is none.
            let is_none = ours.is_nan() && theirs.is_nan();
            assert!(
                is_none || ours.to_bits() == theirs.to_bits(),
                "{name}: {ours}, {theirs}"
            );
        }
    };
    let (measures, rest) = theirs.split_at_checked(COUNT).unwrap();
    same(page.measures(), measures);
    let (numbers, rest) = rest.split_at_checked(2).unwrap();
    let findings = page.findings();
    let ours = [page.steps(), findings.count].map(u32::to_le_bytes);
    assert_eq!(ours, numbers, "{name}: steps, number of findings");
    let count = findings.count as usize;
    let (outcomes, rest) = rest.split_at_checked(count).unwrap();
    for (ours, word) in findings.outcomes.iter().zip(outcomes) {
        assert_eq!(*ours, u32::from_le_bytes(*word), "{name}");
    }
    let (reached, rest) = rest.split_at_checked(count).unwrap();
    same(&findings.reached, reached);
    let (needed, rest) = rest.split_at_checked(count).unwrap();
    same(&findings.needed, needed);
    rest
}

#[test]
fn the_page_is_the_native_knee_to_the_bit() {
    let (knees, motion) = (knees(), motion());
    let Some(theirs) = in_node(&knees, &motion) else {
        return;
    };
    let (mut theirs, _) = theirs.as_chunks::<4>();
    let mut page = Box::new(Page::new());
    let mut silent = Vec::new();
    for Knee { name, ids, values } in &knees {
        page.begin().unwrap();
        for (id, value) in ids.iter().zip(values) {
            assert!(page.set(u32::from(*id), *value));
        }
        page.commit().unwrap();
        let mut resists = false;
        for (frame, (ticks, angle)) in motion.iter().enumerate() {
            page.hand(*angle, true);
            let count = page.advance(*ticks) as usize;
            let columns = page.columns();
            resists |= columns.torque_nm[..count].iter().any(|nm| *nm != 0.0);
            let ours = bytes(columns, count);
            let (of_frame, rest) = theirs.split_at_checked(ours.len()).unwrap();
            theirs = rest;
            if let Some(off) = ours.iter().zip(of_frame).position(|(a, b)| a != b) {
                let (column, tick) = (off / count, off % count);
                panic!("{name}: column {column}, frame {frame}, tick {tick}");
            }
        }
        theirs = examined(name, &page, theirs);
        if !resists {
            silent.push(name.as_str());
        }
    }
    assert!(theirs.is_empty(), "{} numbers too many", theirs.len());
    // What asks for nothing compares nothing.
    assert_eq!(silent, SILENT);
    println!("{} knees, {TICKS} ticks each", knees.len());
}

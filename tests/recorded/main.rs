//! Recordings as their users meet them: names, hints, exports, damage.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "small numbers"
)]

#[cfg(target_os = "linux")]
mod cost;
mod exports;
mod reports;
#[path = "../support/mod.rs"]
mod support;

use crepitus_recording::{Damage, Recording};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;
use support::{check_accounting, crepitus, names, recording, run, stderr, stdout, summary};

/// A recording of the simulated device, half a second long.
fn record(folder: &Path, name: &str) -> Output {
    crepitus()
        .current_dir(folder)
        .args([
            "record", "--device", "sim", "--for", "500ms", "--arm", "--zero", "--", name,
        ])
        .output()
        .unwrap()
}

fn recorded(folder: &Path, name: &str) -> PathBuf {
    let output = record(folder, name);
    assert!(output.status.success(), "{}", stderr(&output));
    folder.join(name)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn any_name_works_and_the_hint_can_be_pasted() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    // A folder with `-report` in its name would be too long.
    let long = "n".repeat(250);
    let all = [
        long.as_str(),
        "x.json",
        "x.csv",
        "x.parquet",
        "x",
        "run.1",
        "noext",
        "two words",
        "it's",
        "-dash",
        "$HOME",
        "knie ö",
        "a\nb",
    ];
    for name in all {
        let output = record(folder, name);
        assert!(output.status.success(), "{name:?}: {}", stderr(&output));
        let said = stdout(&output);
        let hint = said.split('`').nth(1).unwrap();
        let program = env!("CARGO_BIN_EXE_crepitus");
        let hint = hint.replacen("crepitus", &format!("'{program}'"), 1);
        // As a person pastes it.
        let pasted = Command::new("bash")
            .current_dir(folder)
            .args(["-c", &hint])
            .output()
            .unwrap();
        assert!(pasted.status.success(), "{hint}: {}", stderr(&pasted));
    }
    // Each recording and each report stands, none wrote over another.
    assert_eq!(names(folder).len(), 2 * all.len(), "{:?}", names(folder));
    for name in all {
        let recording = recording(&folder.join(name));
        assert!(recording.is_complete());
        assert_eq!(check_accounting(&recording).dropped, 0);
        let again = record(folder, name);
        assert_eq!(again.status.code(), Some(2));
        assert!(stderr(&again).contains("already exists"));
    }
}

/// The device stops when the leg leaves the range of motion.
#[test]
fn a_recording_that_a_fault_has_ended_names_it() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("a");
    let device = ["--device", "sim", "--scene", "high-speed"];
    let record = [
        &["record", text(&file), "--arm", "--zero", "--for", "20s"][..],
        &device,
    ]
    .concat();
    let output = run(&record);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("outside-range"),
        "{}",
        stderr(&output)
    );
    let out = home.path().join("out");
    let report = run(&["report", text(&file), "--out", text(&out), "--json"]);
    let report: Value = serde_json::from_str(&stdout(&report)).unwrap();
    let summary = support::summary(&out);
    for summary in [&report["summary"], &summary] {
        let summary = if summary.is_null() { &report } else { summary };
        assert_eq!(summary["ending"]["cause"], "fault", "{summary}");
        let fault = summary["ending"]["faults"][0].as_str().unwrap();
        assert!(fault.starts_with("outside-range"), "{fault}");
        let warnings = summary["warnings"].to_string();
        assert!(warnings.contains("ended early") && warnings.contains("outside-range"));
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("ended early") && page.contains("outside-range"));
    // One that ends in its time says nothing.
    let whole = recorded(home.path(), "b");
    let opened = recording(&whole);
    assert_eq!(opened.warnings(), [""; 0]);
    assert_eq!(
        opened.ending().unwrap().cause,
        crepitus_recording::EndCause::Time
    );
}

#[test]
fn a_refused_recording_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("a");
    // A device that is not there; `sharing.rs` has one that refuses to arm.
    let output = run(&[
        "record",
        text(&file),
        "--device",
        "none-of-this-name",
        "--arm",
        "--zero",
    ]);
    assert!(!output.status.success());
    assert_eq!(names(home.path()), [""; 0]);
    let folder = home.path().join("no folder").join("a");
    let output = run(&["record", text(&folder), "--device", "sim", "--for", "100ms"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("cannot be created"),
        "{}",
        stderr(&output)
    );
}

/// The Ctrl-C that ends the recording does not end the making of its final file, which looks for a request to
/// stop after each 40,000 rows.
#[cfg(target_os = "linux")]
#[test]
fn a_recording_that_ctrl_c_ends_becomes_a_parquet_file() {
    use support::served::{signal, until};
    use support::{HALF_A_SECOND, length};
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("a");
    let mut program = crepitus()
        .args(["record", "--device", "sim", text(&file)])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until("two and a half seconds are recorded", || {
        assert!(program.try_wait().unwrap().is_none(), "it has ended");
        length(&file) > 5 * HALF_A_SECOND
    });
    signal(&program, "-INT");
    let output = program.wait_with_output().unwrap();
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    let is_left = said.contains("in the format of a recording in progress");
    assert!(!is_left, "{said}");
    assert!(fs::read(&file).unwrap().starts_with(b"PAR1"));
    let recording = recording(&file);
    assert!(recording.is_complete());
    assert!(check_accounting(&recording).received > 40_000);
}

/// A recording that nobody can read is not reported as whole.
#[test]
fn a_recording_that_was_removed_while_it_ran_is_no_success() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("gone");
    let mut program = crepitus()
        .current_dir(home.path())
        .args(["record", "--device", "sim", "--for", "20s", "gone"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while fs::remove_file(&file).is_err() {
        assert!(program.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(1));
    }
    let output = program.wait_with_output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("was moved, removed or changed while it ran"),
        "{said}"
    );
    assert_eq!(stdout(&output), "");
}

/// Its end goes by the file's name, which another recording may have by then.
#[test]
fn a_recording_that_was_moved_while_it_ran_replaces_no_other() {
    let home = tempfile::tempdir().unwrap();
    let other = recorded(home.path(), "other");
    let file = home.path().join("a");
    let mut program = crepitus()
        .current_dir(home.path())
        .args(["record", "--device", "sim", "--for", "20s", "a"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !file.exists() {
        assert!(program.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(1));
    }
    let moved = home.path().join("moved");
    fs::rename(&file, &moved).unwrap();
    fs::copy(&other, &file).unwrap();
    let output = program.wait_with_output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("is another recording now"), "{said}");
    assert_eq!(fs::read(&file).unwrap(), fs::read(&other).unwrap());
    let recording = Recording::open(&moved, Damage::Refuse).unwrap();
    assert!(recording.is_complete());
    assert!(recording.accounting().totals.received > 0);
}

/// A log of which the middle is missing, with a picture of that.
#[test]
fn what_is_missing_is_said_first_and_drawn() {
    let home = tempfile::tempdir().unwrap();
    let log = home.path().join("log");
    let damaged = home.path().join("damaged");
    let whole = recording_in_progress(&log);
    let mut bytes = whole.clone();
    let middle = bytes.len() / 2;
    bytes[middle..middle + 20_000].fill(0);
    fs::write(&damaged, &bytes).unwrap();
    let output = run(&["report", text(&damaged)]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    for part in ["damaged:", "bytes from byte", "--salvage"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!(names(home.path()), ["damaged", "log"]);
    let output = run(&["report", text(&damaged), "--salvage"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    let (missing, length) = (
        said.find("are missing").unwrap(),
        said.find(" s of it armed").unwrap(),
    );
    assert!(missing < length, "{said}");
    let folder = home.path().join("damaged-report");
    let numbers = summary(&folder);
    let warnings = numbers["warnings"].as_array().unwrap();
    assert!(warnings[0].as_str().unwrap().contains("damaged"));
    let missing = numbers["telemetry"]["damaged"].as_u64().unwrap();
    assert!((1_000..1_400).contains(&missing), "{missing}");
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    let table = page.find("Missing samples").expect("a table");
    assert!(table < page.find("Parameters: revision").unwrap());
    assert!(page.contains("Blank between dotted lines"));
    // The same report without a gap has none.
    assert!(run(&["report", text(&log)]).status.success());
    let page = fs::read_to_string(home.path().join("log-report/report.html")).unwrap();
    assert!(!page.contains("Blank between") && !page.contains("Missing samples"));
    // What was salvaged can be kept as a whole file.
    let kept = home.path().join("kept.parquet");
    let export = [
        "export",
        text(&damaged),
        "--format",
        "parquet",
        "--out",
        text(&kept),
    ];
    assert_eq!(run(&export).status.code(), Some(2));
    let output = run(&[&export[..], &["--salvage"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let kept = recording(&kept);
    assert_eq!(check_accounting(&kept).damaged, missing);
}

/// The file as it was before it became Parquet: that of a full disk.
fn recording_in_progress(path: &Path) -> Vec<u8> {
    use crepitus_protocol::management::Identity;
    use crepitus_protocol::telemetry::{Block, BlockFlags};
    use crepitus_protocol::{Revision, State, Values};
    use crepitus_recording::{Begin, Metadata, Recorder};
    let metadata = Metadata::new("a test", &Identity::default(), None);
    let mut recorder = Recorder::create(path, &metadata).unwrap();
    let begin = Begin {
        first_tick: 100,
        ..Begin::default()
    };
    recorder.subscribed(begin).unwrap();
    recorder.announce(Revision(1), &Values::default());
    for n in 0..1_500 {
        let first_tick = 100 + 20 * n;
        let mut block = Block {
            first_tick,
            revision: Revision(1),
            flags: BlockFlags::new(State::Armed, true, 0),
            ..Block::default()
        };
        for (at, sample) in block.samples.iter_mut().enumerate() {
            let t = (first_tick + at as u64) as f64 * 5e-5;
            sample.count = (2_000.0 * t.sin()) as i32;
            sample.model_torque_nm = (30.0 * t).sin() as f32;
        }
        recorder.block(&block).unwrap();
    }
    recorder.finish().unwrap();
    fs::read(path).unwrap()
}

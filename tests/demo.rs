//! The main job: the whole chain in one process.

mod support;

use serde_json::Value;
use std::fs;
use std::time::{Duration, Instant};
use support::{check_accounting, names, recording, refuses, rows, run, stderr, stdout, summary};

#[test]
fn the_demo_records_and_reports_every_sample() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("demo");
    let begun = Instant::now();
    let output = run(&["demo", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(begun.elapsed() < Duration::from_secs(30));
    assert_eq!(
        names(&out),
        ["recording.parquet", "report.html", "summary.json"]
    );
    let summary = summary(&out);
    let telemetry = &summary["telemetry"];
    assert_eq!(telemetry["dropped"], 0);
    assert_eq!(telemetry["produced"], telemetry["received"]);
    assert!(telemetry["received"].as_u64().unwrap() >= 240_000);
    assert!(summary["breaks"].as_u64().unwrap() > 100);
    // Both changes took effect during the run, at times in the recording.
    let sets = summary["parameters"].as_array().unwrap();
    assert_eq!(sets.len(), 3);
    assert_eq!(sets[1]["values"]["crepitus.kinetic_torque_nm"], 0.25);
    assert_eq!(sets[2]["values"]["crepitus.stiffness_nm_per_rad"], 900.0);
    // It prints the paths of all files.
    let text = stdout(&output);
    for part in [
        "report.html",
        "recording.parquet",
        "revision 3",
        "0 dropped",
    ] {
        assert!(text.contains(part), "{part} is missing in:\n{text}");
    }
    // No row is missing, and the revision changes where it should.
    let recording = recording(&out.join("recording.parquet"));
    assert!(recording.is_complete());
    check_accounting(&recording);
    let mut revisions = Vec::new();
    for pair in rows(&recording).windows(2) {
        if pair[0].revision != pair[1].revision {
            revisions.push((pair[1].tick, pair[1].revision));
        }
    }
    for (set, (tick, revision)) in sets[1..].iter().zip(&revisions) {
        assert_eq!(set["first_tick"].as_u64(), Some(*tick));
        assert_eq!(set["revision"], *revision);
    }
    assert_eq!(revisions.len(), 2);
}

#[test]
fn the_demo_may_be_run_again_and_does_the_same() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("demo");
    let record = || {
        let output = run(&["demo", "--json", "--out", out.to_str().unwrap()]);
        assert!(output.status.success(), "{}", stderr(&output));
        let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(said["summary"]["telemetry"]["dropped"], 0);
        rows(&recording(&out.join("recording.parquet")))
    };
    assert!(record() == record(), "the same program, the same samples");
}

#[test]
fn the_demo_replaces_nothing_that_is_not_its_own() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().to_str().unwrap();
    let own = home.path().join("recording.parquet");
    let file = own.to_str().unwrap();
    let made = run(&["record", file, "--device", "sim", "--for", "100ms"]);
    assert!(made.status.success(), "{}", stderr(&made));
    let before = fs::read(&own).unwrap();
    refuses(
        &["demo", "--out", out],
        2,
        "recording.parquet (not written by crepitus)",
    );
    fs::write(home.path().join("summary.json"), r#"{"scene_as_run": ""}"#).unwrap();
    refuses(
        &["demo", "--out", out],
        2,
        "recording.parquet, summary.json (not",
    );
    assert_eq!(fs::read(&own).unwrap(), before);
    assert_eq!(names(home.path()), ["recording.parquet", "summary.json"]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_demo_leaves_nothing() {
    use support::served::{ended, signal, until};
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("demo");
    let mut child = support::crepitus()
        .args(["demo", "--json", "--out", out.to_str().unwrap()])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let is_recorded = || {
        let parts = fs::read_dir(home.path()).unwrap().flatten();
        parts
            .map(|part| part.path().join("files/recording.parquet"))
            .any(|file| support::length(&file) > support::HALF_A_SECOND)
    };
    until("the demo records", is_recorded);
    signal(&child, "-INT");
    assert_eq!(ended(&mut child).code(), Some(1));
    let output = child.wait_with_output().unwrap();
    assert_eq!(stderr(&output), "");
    assert_eq!(names(home.path()), Vec::<String>::new());
}

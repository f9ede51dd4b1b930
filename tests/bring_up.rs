//! `crepitus bring-up` on simulated boards: a healthy one, and one with each fault of its wiring.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;
use support::{names, run, stderr, stdout};

/// Each fault of the wiring, and the row that has to find it first.
const FAULTS: [(&str, &str); 12] = [
    ("link-cut", "drive"),
    ("link-noisy", "samples"),
    ("encoder-unplugged", "encoder"),
    ("read-back-cut", "lines"),
    ("amplifier-offset", "offset"),
    ("divider-wrong", "supply"),
    ("sensor-unplugged", "heat"),
    ("break-cut", "break"),
    ("stop-bridged", "stop"),
    ("motor-swapped", "polarity"),
    ("watchdog-frozen", "watchdog"),
    ("stops-narrow", "limits"),
];

/// Rows that a device measures.
const MEASURED: usize = 14;

fn bring_up(out: &Path, more: &[&str]) -> (Output, Value) {
    let out = out.to_str().unwrap();
    let first = ["bring-up", "--device", "sim", "--yes", "--out", out];
    let done = run(&[&first[..], more].concat());
    let text = fs::read_to_string(Path::new(out).join("bring-up.json"));
    let text = text.unwrap_or_else(|_| panic!("{}{}", stdout(&done), stderr(&done)));
    (done, serde_json::from_str(&text).unwrap())
}

fn count(record: &Value, result: &str) -> usize {
    let rows = record["rows"].as_array().unwrap();
    rows.iter().filter(|row| row["result"] == result).count()
}

#[test]
fn a_healthy_board_passes_and_leaves_a_record() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (done, record) = bring_up(&out, &[]);
    assert!(done.status.success(), "{}{}", stdout(&done), stderr(&done));
    assert_eq!(names(&out), ["bring-up.json", "report.html"]);
    assert_eq!(record["first_wrong"], Value::Null);
    assert_eq!(count(&record, "good"), MEASURED, "{record}");
    assert_eq!(count(&record, "by hand"), 29 - MEASURED);
    // A builder is told what to do while the device is armed.
    for what in ["now: press the stop", "now: pull the break line low"] {
        assert!(stderr(&done).contains(what), "{}", stderr(&done));
    }
}

#[test]
fn each_fault_of_the_wiring_is_found_and_named_at_its_row() {
    for (fault, row) in FAULTS {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let (done, record) = bring_up(&out, &["--wiring-fault", fault]);
        assert_eq!(done.status.code(), Some(1), "{fault}: {}", stdout(&done));
        assert_eq!(record["first_wrong"], row, "{fault}: {}", stdout(&done));
        assert!(stdout(&done).contains("to do: "), "{fault}");
    }
}

#[test]
fn rows_are_chosen_by_name_or_number() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (done, record) = bring_up(&out, &["--rows", "encoder,16"]);
    assert!(done.status.success(), "{}", stdout(&done));
    let rows = record["rows"].as_array().unwrap();
    let named: Vec<_> = rows
        .iter()
        .map(|row| row["name"].as_str().unwrap())
        .collect();
    assert_eq!(named, ["encoder", "supply"]);
}

#[test]
fn what_cannot_be_is_refused() {
    for (arguments, says) in [
        ("--yes --device sim --rows nonsense", "no row is called"),
        (
            "--device emulated --yes --wiring-fault stop-bridged",
            "only a simulated board has one",
        ),
        ("--yes --device sim --scene fig6-cycle", "has its own"),
    ] {
        let words: Vec<&str> = ["bring-up"]
            .into_iter()
            .chain(arguments.split(' '))
            .collect();
        let done = run(&words);
        assert_eq!(done.status.code(), Some(2), "{}", stderr(&done));
        assert!(stderr(&done).contains(says), "{}", stderr(&done));
    }
}

//! Every verb that talks to a device, on the firmware's own images: `--device
//! emulated`.
//!
//! The emulator is part of the program in a build of the whole workspace, and with
//! `--features emulator`; otherwise the program says how it gets it.

mod support;

use serde_json::Value;
use std::env::var_os;
use std::process::Output;
use support::{check_accounting, recording, run, stderr, stdout};

fn emulated(arguments: &[&str]) -> Output {
    let mut all = arguments.to_vec();
    all.extend(["--device", "emulated"]);
    run(&all)
}

/// Returns whether there is an emulator, and a target to build the images for.
fn is_there() -> bool {
    let output = emulated(&["info", "--json"]);
    let message = stderr(&output);
    if message.contains("built without the emulator") {
        assert_eq!(output.status.code(), Some(2));
        assert!(message.contains("--features emulator"), "{message}");
        assert!(var_os("CREPITUS_NEEDS_TARGET").is_none(), "{message}");
        println!("left out: {message}");
        return false;
    }
    if message.contains("is not installed") && var_os("CREPITUS_NEEDS_TARGET").is_none() {
        println!("left out: {message}");
        return false;
    }
    assert!(output.status.success(), "{message}");
    true
}

fn done(arguments: &[&str]) -> String {
    let output = emulated(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        stderr(&output)
    );
    stdout(&output)
}

fn json(arguments: &[&str]) -> Value {
    let mut all = arguments.to_vec();
    all.push("--json");
    serde_json::from_str(&done(&all)).expect("JSON")
}

#[test]
fn every_verb_works_on_the_images() {
    if !is_there() {
        return;
    }
    let info = json(&["info"]);
    assert_eq!(info["status"]["state"], "disarmed");
    assert_eq!(info["comms"]["schema"], info["drive"]["schema"]);
    let schema = info["drive"]["schema"].as_str().expect("a text");
    assert_eq!(schema.len(), 16, "{schema}");
    assert_eq!(info["status"]["revision"], info["status"]["in_force"]);
    assert_eq!(info["counters"]["drive"]["dropped-samples"], 0);
    let records = json(&["info", "--crash"]);
    assert_eq!(records, serde_json::json!({ "comms": null, "drive": null }));
    let got = json(&["params", "get", "crepitus.static_torque_nm"]);
    assert_eq!(got["values"]["crepitus.static_torque_nm"], 0.4);
    let set = json(&["params", "set", "crepitus.static_torque_nm=0.5"]);
    assert_eq!(set["revision"], 2);
    assert_eq!(json(&["params", "apply", "fine"])["revision"], 2);
    for verb in [
        &["params", "save"][..],
        &["zero"],
        &["disarm"],
        &["stop"],
        &["clear-fault"],
        &["arm", "--zero", "--for", "50ms"],
    ] {
        done(verb);
    }
    let rows = done(&["stream", "--for", "100ms", "--rate", "1000"]);
    let rows = rows.lines().count();
    assert!((90..=120).contains(&rows), "{rows} rows");
}

#[test]
fn a_recording_of_the_images_has_an_exact_accounting() {
    if !is_there() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("emulated.crepitus");
    let path = file.to_str().expect("a path");
    done(&["record", path, "--for", "300ms", "--arm", "--zero"]);
    let recording = recording(&file);
    check_accounting(&recording);
}

#[test]
fn the_doctor_finds_nothing_wrong_with_the_images() {
    if !is_there() {
        return;
    }
    let report = json(&["doctor"]);
    assert_eq!(report["fine"], true, "{report:#}");
    let checks = report["checks"].as_array().expect("checks");
    for what in ["drive times", "comms times"] {
        let check = checks.iter().find(|check| check["what"] == what);
        let found = check.expect(what)["found"].as_str().expect("a text");
        assert!(found.contains("emulated cycles"), "{found}");
    }
}

#[test]
fn a_scene_that_no_device_renders_is_refused_with_its_reason() {
    if !is_there() {
        return;
    }
    let output = emulated(&["info", "--scene", "knee-pass-physical"]);
    assert_eq!(output.status.code(), Some(2));
    let sim = run(&["info", "--device", "sim", "--scene", "knee-pass-physical"]);
    let reason = stderr(&output);
    assert!(
        reason.contains("a device renders the convention"),
        "{reason}"
    );
    assert_eq!(reason.lines().last(), stderr(&sim).lines().last());
}

//! The verbs that talk to a device, with the simulated one of `--device sim`.

#[cfg(target_os = "linux")]
mod backup;
#[path = "../support/mod.rs"]
mod support;

use serde_json::Value;
use std::fs;
use support::{check_accounting, recording, run, run_line, stderr, stdout, summary, words};

/// Runs a verb on a simulated device.
fn sim(arguments: &[&str]) -> std::process::Output {
    let mut all = arguments.to_vec();
    all.extend(["--device", "sim"]);
    run(&all)
}

fn done(arguments: &[&str]) -> String {
    let output = sim(arguments);
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
fn info_reports_identity_and_status() {
    let info = json(&["info"]);
    assert_eq!(info["status"]["state"], "disarmed");
    assert_eq!(info["comms"]["schema"], info["drive"]["schema"]);
    let schema = info["drive"]["schema"].as_str().unwrap();
    assert_eq!(schema.len(), 16, "{schema}");
    assert_eq!(info["status"]["revision"], info["status"]["in_force"]);
    assert_eq!(info["counters"]["drive"]["dropped-samples"], 0);
    assert!(done(&["info"]).contains("state   disarmed"));
}

#[test]
fn a_device_that_never_crashed_has_no_record() {
    let records = json(&["info", "--crash"]);
    assert_eq!(records, serde_json::json!({ "comms": null, "drive": null }));
    let text = done(&["info", "--crash"]);
    assert!(text.contains("drive   no crash since power-on"), "{text}");
}

#[test]
fn the_doctor_finds_nothing_wrong() {
    let report = json(&["doctor"]);
    assert_eq!(report["fine"], true, "{report:#}");
    let checks = report["checks"].as_array().unwrap();
    assert!(checks.len() >= 10);
    // Nothing counts cycles here.
    let times = checks.iter().find(|check| check["what"] == "drive times");
    let found = times.unwrap()["found"].as_str().unwrap();
    assert!(found.starts_with("not measured"), "{found}");
}

#[test]
fn the_doctor_says_what_is_felt_of_the_gear() {
    let felt = |arguments: &[&str]| done(&[&["doctor"], arguments].concat());
    let compensated = felt(&[]);
    let line = "ok    friction    0.10 of the gear's 0.50 N·m are felt beside the joint\n";
    assert!(compensated.contains(line), "{compensated}");
    let off = felt(&["--scene", "weight-in-the-brace"]);
    let parts = [
        "0.50 of the gear's 0.50 N·m",
        "compensation is off",
        "`crepitus calibrate --apply`",
    ];
    assert!(parts.iter().all(|part| off.contains(part)), "{off}");
}

#[test]
fn parameters_are_listed_read_and_set() {
    let list: Value = serde_json::from_str(&stdout(&run(&["params", "list", "--json"]))).unwrap();
    assert_eq!(list.as_array().unwrap().len(), 125);
    assert_eq!(list[4]["name"], "crepitus.static_torque_nm");
    let got = "params get crepitus.static_torque_nm crepitus.restart";
    let got = json(&words(got));
    assert_eq!(got["values"]["crepitus.static_torque_nm"], 0.4);
    assert_eq!(got["values"]["crepitus.restart"], "elastic");
    let set = "params set crepitus.static_torque_nm=0.5 crepitus.restart=from-kinetic";
    let set = json(&words(set));
    assert_eq!(set["revision"], 2);
    let file = support::repository().join("scenes/everything.toml");
    for what in ["fine", "bone-shaping", file.to_str().unwrap()] {
        assert_eq!(json(&["params", "apply", what])["revision"], 2, "{what}");
    }
    done(&["params", "save"]);
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_saved_is_the_revision_in_use() {
    let served = support::served::Served::new();
    let set = served.run(&["params", "set", "crepitus.static_torque_nm=0.5"]);
    assert!(set.status.success(), "{}", stderr(&set));
    let before = &served.info()["status"];
    assert_eq!(before["revision"], 2);
    assert_ne!(before["saved"], before["revision"]);
    let saved = served.run(&["params", "save"]);
    assert!(saved.status.success(), "{}", stderr(&saved));
    let after = &served.info()["status"];
    assert_eq!(after["revision"], before["revision"]);
    assert_eq!(after["saved"], after["revision"]);
}

/// A rejected request reports the cause and the remedy.
#[test]
fn invalid_values_are_rejected_with_the_reason() {
    for (arguments, code, parts) in [
        (
            &["params", "set", "crepitus.static_torque_nm=0.1"][..],
            2,
            &[
                "kinetic_torque_nm",
                "static_torque_nm",
                "nothing was changed",
            ][..],
        ),
        (
            &["params", "set", "crepitus.static_torque_nm=nan"],
            2,
            &["crepitus.static_torque_nm"],
        ),
        (
            &["params", "set", "crepitus.static_torque_nm=lots"],
            2,
            &["lots"],
        ),
        (
            &["params", "set", "crepitus.restart=maybe"],
            2,
            &["elastic", "from-kinetic"],
        ),
        (
            &["params", "set", "crepitus.static_torque=0.5"],
            2,
            &["did you mean", "crepitus.static_torque_nm"],
        ),
        (&["params", "set", "static=0.5"], 2, &["params list"]),
        (
            &["params", "apply", "no-such-thing"],
            2,
            &["no-such-thing", "crepitus presets"],
        ),
        (
            &["params", "apply", "knee-pass-physical"],
            2,
            &["frozen", "physical"],
        ),
        (&["stream", "--rate", "300"], 2, &["20000", "250 or 400"]),
        (&["stream", "--for", "soon"], 2, &["soon", "30s"]),
        (&["info", "--scene", "no-such-scene"], 2, &["no-such-scene"]),
    ] {
        let output = sim(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
        for part in parts {
            assert!(
                text.contains(part),
                "{arguments:?}: {part:?} is missing in {text}"
            );
        }
    }
}

#[test]
fn no_device_is_an_error_that_names_the_simulated_one() {
    let home = tempfile::tempdir().unwrap();
    for arguments in [
        &["info"][..],
        &["info", "--device", "nobody"],
        &["info", "--device", "/dev/no-such-port"],
    ] {
        let output = support::crepitus()
            .args(arguments)
            .env("XDG_RUNTIME_DIR", home.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        let text = stderr(&output);
        assert!(
            text.contains("--device sim") || text.contains("crepitus devices"),
            "{text}"
        );
    }
}

#[test]
fn control_does_what_it_says() {
    assert_eq!(done(&["zero"]), "zero set\n");
    assert_eq!(done(&["disarm"]), "disarmed\n");
    assert_eq!(done(&["stop"]), "stopped\n");
    assert_eq!(done(&["clear-fault"]), "faults cleared\n");
    assert_eq!(
        done(&["arm", "--zero", "--for", "1s"]),
        "disarmed: the duration has elapsed\n"
    );
}

#[test]
fn samples_are_streamed_at_the_requested_rate() {
    let text = done(&["stream", "--for", "2s", "--rate", "100", "--arm", "--zero"]);
    let lines: Vec<_> = text.lines().collect();
    assert!((200..=205).contains(&(lines.len() - 1)), "{}", lines.len());
    assert!(lines[0].starts_with("tick,t_s,count,angle_rad"));
    let armed = lines[1..]
        .iter()
        .filter(|l| !l.contains("not-armed"))
        .count();
    assert!(armed > 190, "{armed}");
    let text = done(&[
        "stream", "--for", "100ms", "--rate", "1000", "--format", "jsonl",
    ]);
    for line in text.lines() {
        let sample: Value = serde_json::from_str(line).unwrap();
        assert_eq!(sample["limit"], "not-armed");
        assert!(sample["model_torque_nm"].is_number());
    }
    assert!(text.lines().count() >= 100);
}

#[test]
fn a_recording_is_reported() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("try");
    let path = file.to_str().unwrap();
    let said = json(&[
        "record",
        path,
        "--for",
        "2s",
        "--arm",
        "--zero",
        "--title",
        "First try",
    ]);
    assert_eq!(said["telemetry"]["dropped"], 0);
    let totals = check_accounting(&recording(&file));
    assert_eq!(said["telemetry"]["received"], totals.received);
    // It is not written over.
    let again = sim(&["record", path, "--for", "1s"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("exists"));

    let output = run(&["report", path]);
    assert!(output.status.success(), "{}", stderr(&output));
    let folder = home.path().join("try-report");
    let numbers = summary(&folder);
    assert_eq!(numbers["title"], "First try");
    assert!(numbers["armed_s"].as_f64().unwrap() > 1.9);
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("First try") && page.contains("<svg"));

    // A file that is no recording is rejected.
    fs::write(&file, "t,x\n1,2\n").unwrap();
    let output = run(&["report", path]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("not a recording"));
}

/// The leg of this scene leaves the range of motion, and the drive turns off.
#[test]
fn a_recording_that_a_fault_ends_is_named() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("try");
    let output = run_line(&format!(
        "record {} --device sim --scene high-speed --arm --zero --json",
        file.display()
    ));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(said["file"].as_str(), file.to_str());
    assert_eq!(said["error"]["exit_code"], 1);
    let received = check_accounting(&recording(&file)).received;
    assert_eq!(said["telemetry"]["received"], received);
    let message = said["error"]["message"].as_str().unwrap();
    for part in [
        "fault 23",
        &format!("holds {received} samples"),
        "crepitus report",
    ] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn a_scene_is_only_that_of_a_simulated_device() {
    let home = tempfile::tempdir().unwrap();
    for device in [&[][..], &["--device", "knee"], &["--device", "/dev/null"]] {
        let output = support::crepitus()
            .args(["info", "--scene", "everything"])
            .args(device)
            .env("XDG_RUNTIME_DIR", home.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{device:?}");
        assert!(stderr(&output).contains("--scene everything: only a simulated"));
    }
}

#[test]
fn what_would_count_for_nothing_is_refused() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("none");
    let file = file.to_str().unwrap();
    let twice = [
        "crepitus.static_torque_nm=0.5",
        "crepitus.static_torque_nm=0.6",
    ];
    for (arguments, part) in [
        (&["params", "set", twice[0], twice[1]][..], "is set twice"),
        (
            &["record", file, "--for", "0s"],
            "--for: expected a time above 0",
        ),
        (
            &["stream", "--rate", "1e3"],
            "expected a whole number from 1 to 20000",
        ),
    ] {
        let output = sim(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    assert_eq!(support::names(home.path()), Vec::<String>::new());
}

/// In a hurry nobody types a name.
#[cfg(target_os = "linux")]
#[test]
fn stop_without_a_name_stops_every_device() {
    use std::process::Stdio;
    use support::served::{Served, ended, until};
    let mut served = Served::new();
    served.add("left");
    let mut arms = ["knee", "left"].map(|name| {
        served
            .command(&["arm", "--zero", "--device", name])
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    });
    for name in ["knee", "left"] {
        until("armed", || {
            let output = served.run(&["info", "--json", "--device", name]);
            stdout(&output).contains("\"armed\"")
        });
    }
    let output = served.run(&["stop"]);
    let said = stdout(&output);
    assert!(said.starts_with("stopped 2 devices; "), "{said}");
    for arm in &mut arms {
        assert!(said.contains(&format!("process {} ", arm.id())), "{said}");
        assert!(!ended(arm).success());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_no_terminal_is_no_port() {
    support::refuses(
        &["info", "--device", "/dev/null"],
        2,
        "it is no serial port",
    );
}

/// Without a terminal no key can disarm.
#[test]
fn arm_names_what_disarms() {
    let output = support::crepitus()
        .args(["arm", "--device", "sim", "--zero", "--for", "100ms"])
        .stdin(std::process::Stdio::null())
        .output()
        .unwrap();
    assert_eq!(stderr(&output), "armed: Ctrl-C disarms\n");
}

/// The text of an error must not be lost with the reader's disk.
#[cfg(target_os = "linux")]
#[test]
fn an_error_that_stdout_cannot_take_goes_to_stderr() {
    let output = support::crepitus()
        .args(["info", "--json", "--device", "/dev/null"])
        .stdout(fs::File::create("/dev/full").unwrap())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("/dev/null"), "{}", stderr(&output));
}

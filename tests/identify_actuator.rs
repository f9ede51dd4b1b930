//! `crepitus identify-actuator` on recordings of a bench.

#[path = "../host/identify/tests/support/mod.rs"]
mod actuator;
mod support;

use actuator::{NOMINAL, Simulated};
use crepitus_model::control::chirp::ChirpSettings;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use support::{done, refuses, repository, run, stderr, stdout, words};

/// An actuator that is none of the data sheet.
const OURS: Simulated = Simulated {
    resistance_ohm: 2.1,
    force_constant: 0.95,
    mass_kg: 0.052,
    resonance_hz: 41.0,
    damping_ratio: 0.08,
    ..NOMINAL
};

fn recorded(truth: &Simulated, path: &Path) {
    let series = truth.played(&ChirpSettings::default(), &mut fastrand::Rng::with_seed(2));
    let mut text = "t_s,volts,amperes\n".to_owned();
    for (i, (volts, amperes)) in (0_u32..).zip(series.volts().iter().zip(series.amperes())) {
        let time_s = f64::from(i) * series.step_s();
        writeln!(text, "{time_s:.5},{volts:.6},{amperes:.4}").unwrap();
    }
    fs::write(path, text).unwrap();
}

fn value<'v>(summary: &'v Value, name: &str) -> &'v Value {
    let values = summary["values"].as_array().unwrap();
    values.iter().find(|value| value["name"] == name).unwrap()
}

#[test]
fn a_bench_recording_gives_a_table_a_plot_and_json() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, out) = (folder.path().join("bench.csv"), folder.path().join("out"));
    recorded(&OURS, &csv);
    let [csv, out_name] = [&csv, &out].map(|path| path.to_str().unwrap());
    let from = ["identify-actuator", "--from", csv, "--moving-mass-g", "52"];
    let done = run(&[&from[..], &["--out", out_name]].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let text = stdout(&done);
    let row = |name: &str| text.lines().find(|line| line.contains(name)).unwrap();
    assert!(
        row("vibration-actuator.resonance_hz").contains("41.0"),
        "{text}"
    );
    assert!(
        row("vibration-actuator.resistance_ohm").contains(" 1.800 "),
        "{text}"
    );
    assert!(row("force_constant_n_per_a").contains("weight"), "{text}");
    assert!(stderr(&done).contains("nothing in the current tells a wrong mass"));
    let svg = fs::read_to_string(out.join("impedance.svg")).unwrap();
    for title in ["|Z| (Ω)", "Phase (°)", "Residual (%)", "Frequency (Hz)"] {
        assert!(svg.contains(title), "{title}");
    }
    // Measured and fitted twice, the residual, and no number that is none.
    assert!(svg.matches("<path").count() + svg.matches("<polyline").count() >= 5);
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    // The file and the JSON of the command say the same.
    let json = run(&[&["--json"][..], &from].concat());
    let printed: Value = serde_json::from_str(&stdout(&json)).unwrap();
    let written = fs::read_to_string(out.join("summary.json")).unwrap();
    let written: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(printed["identified"], written);
    assert_eq!(printed["revision"], Value::Null);
    for (name, truth) in [
        ("vibration-actuator.resonance_hz", 41.0),
        (
            "vibration-actuator.damping_ratio",
            OURS.whole_damping_ratio(),
        ),
        ("vibration-actuator.moving_mass_g", 52.0),
        ("vibration-actuator.force_constant_n_per_a", 0.95),
        ("vibration-actuator.resistance_ohm", 2.1),
        ("damping ratio of the flexure alone", 0.08),
    ] {
        let found = value(&written, name)["value"].as_f64().unwrap();
        assert!(
            (found / truth - 1.0).abs() < 0.02,
            "{name}: {found} {truth}"
        );
    }
}

#[test]
fn a_second_recording_with_an_added_mass_tells_the_mass() {
    let folder = tempfile::tempdir().unwrap();
    let (bare, heavier) = (
        folder.path().join("bare.csv"),
        folder.path().join("with.csv"),
    );
    recorded(&OURS, &bare);
    recorded(
        &Simulated {
            added_kg: 0.025,
            ..OURS
        },
        &heavier,
    );
    let [bare, heavier] = [&bare, &heavier].map(|path| path.to_str().unwrap());
    let added = ["--from-added", heavier, "--added-mass-g", "25"];
    let both = [&["--json", "identify-actuator", "--from", bare][..], &added].concat();
    let done = run(&both);
    assert!(done.status.success(), "{}", stderr(&done));
    let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
    let mass = value(&printed["identified"], "vibration-actuator.moving_mass_g");
    assert!(
        (mass["value"].as_f64().unwrap() / 52.0 - 1.0).abs() < 0.03,
        "{mass}"
    );
    assert_eq!(mass["source"], "both chirps");
    // A mass that was weighed wrongly contradicts it.
    let wrong = run(&[&both[..], &["--moving-mass-g", "70"]].concat());
    assert_eq!(wrong.status.code(), Some(1));
    assert!(
        stdout(&wrong).contains("70.0 g were given"),
        "{}",
        stdout(&wrong)
    );
}

#[test]
fn what_is_refused_has_its_exit_code_and_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("open.csv");
    recorded(
        &Simulated {
            is_open: true,
            ..OURS
        },
        &csv,
    );
    let from = format!("identify-actuator --from {}", csv.display());
    let weighed = format!("{from} --moving-mass-g 52");
    refuses(&words(&weighed), 1, "the coil is open");
    for (line, text) in [
        (from.clone(), "--moving-mass-g"),
        (format!("{from} --moving-mass-g -1"), "above 0 g"),
        (format!("{from} --added-mass-g 20"), "--from-added"),
        (format!("{weighed} --to-hz 5"), "chirp"),
        (format!("{weighed} --mass-tolerance 50"), "0 to 20 %"),
        (weighed.replace("open.csv", "none.csv"), "none.csv"),
    ] {
        refuses(&words(&line), 2, text);
    }
    let no_table = "identify-actuator --from Cargo.toml --moving-mass-g 52";
    refuses(&words(no_table), 2, "t_s");
}

#[cfg(target_os = "linux")]
#[test]
fn the_device_has_what_was_applied() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("bench.csv");
    recorded(&OURS, &csv);
    let csv = csv.to_str().unwrap();
    let served = support::served::Served::new();
    let verb = ["--json", "identify-actuator", "--moving-mass-g", "52"];
    let more = ["--from", csv, "--device", "knee", "--apply"];
    let done = served.run(&[&verb[..], &more].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
    let got = served.run(&["--json", "params", "get", "--device", "knee"]);
    let got: Value = serde_json::from_str(&stdout(&got)).unwrap();
    assert_eq!(got["revision"], printed["revision"]);
    let values = printed["identified"]["values"].as_array().unwrap();
    let mut applied = 0;
    for found in values {
        // Some of what is found is no parameter.
        let Some(name) = found["parameter"].as_str() else {
            continue;
        };
        let [found, in_use, now] = [&found["value"], &found["in_use"], &got["values"][name]]
            .map(|number| number.as_f64().unwrap());
        assert_ne!(found, in_use, "{name}");
        assert!((now / found - 1.0).abs() < 1e-6, "{name}: {found}, {now}");
        applied += 1;
    }
    assert_eq!(applied, 5);
}

#[test]
fn a_simulated_device_plays_the_chirp_and_its_actuator_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let printed = done(&format!(
        "--json identify-actuator --zero --moving-mass-g 52 --apply --out {} --device sim \
         --scene actuator-in-a-vice",
        out.display()
    ));
    let printed: Value = serde_json::from_str(&printed).unwrap();
    assert!(printed["revision"].as_u64().unwrap() > 1);
    // What the scene's actuator is, which the device does not know.
    for (name, truth) in [
        ("vibration-actuator.resonance_hz", 41.0),
        ("vibration-actuator.damping_ratio", 0.11),
        ("vibration-actuator.moving_mass_g", 52.0),
        ("vibration-actuator.force_constant_n_per_a", 0.95),
        ("vibration-actuator.resistance_ohm", 2.1),
        ("inductance", 0.25),
    ] {
        let found = value(&printed["identified"], name)["value"]
            .as_f64()
            .unwrap();
        assert!(
            (found / truth - 1.0).abs() < 0.03,
            "{name}: {found} {truth}"
        );
    }
    // The recording gives the same again.
    let csv = out.join("measured.csv");
    let again = done(&format!(
        "--json identify-actuator --from {} --moving-mass-g 52",
        csv.display()
    ));
    let again: Value = serde_json::from_str(&again).unwrap();
    let found = |printed: &Value, name: &str| {
        value(&printed["identified"], name)["value"]
            .as_f64()
            .unwrap()
    };
    // Without the hold in the file the last two would be others.
    for name in [
        "vibration-actuator.resonance_hz",
        "inductance",
        "delay of the measurement",
    ] {
        let (once, twice) = (found(&printed, name), found(&again, name));
        assert!(
            (twice / once - 1.0).abs() < 1e-2,
            "{name}: {once}, then {twice}"
        );
    }
    let hz = |printed: &Value| found(printed, "vibration-actuator.resonance_hz");
    assert!((hz(&again) / hz(&printed) - 1.0).abs() < 1e-4);
}

#[test]
fn a_device_whose_actuator_is_off_or_too_weak_for_the_chirp_says_so() {
    let off = "identify-actuator --zero --moving-mass-g 52 --device sim";
    refuses(&words(off), 1, "vibration-actuator.gain=0");
    for (more, part) in [
        ("--amplitude-v 4", "twice its stroke"),
        // Nobody says that the mass is fastened: the standard input is empty.
        ("--added-mass-g 30", "no second chirp"),
    ] {
        let line = format!("{off} --scene actuator-in-a-vice {more}");
        refuses(&words(&line), 1, part);
    }
}

/// The second run found the fault of the first, and awaited a chirp that nobody plays.
#[cfg(target_os = "linux")]
#[test]
fn a_broken_coil_ends_every_run_of_the_same_device() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.toml");
    let shipped = fs::read_to_string(repository().join("scenes/actuator-in-a-vice.toml")).unwrap();
    let (broken, _) = shipped.split_once("[effects.vibration-actuator]").unwrap();
    fs::write(&file, broken).unwrap();
    let served = support::served::Served::with_scene(file.to_str().unwrap());
    // The device believes in a coil that is not there.
    let set =
        words("params set vibration-actuator.render=on vibration-actuator.gain=0 --device knee");
    assert!(served.command(&set).status().unwrap().success());
    let verb = words("identify-actuator --zero --moving-mass-g 52 --device knee");
    for _ in 0..2 {
        let mut child = (served.command(&verb))
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        // A run without an end fails after a minute.
        let status = support::served::ended(&mut child);
        let text = stderr(&child.wait_with_output().unwrap());
        assert_eq!(status.code(), Some(1), "{text}");
        assert!(text.contains("of the coil"), "{text}");
        assert!(text.contains("clear-fault"), "{text}");
        assert_eq!(served.info()["status"]["state"], "disarmed");
    }
}

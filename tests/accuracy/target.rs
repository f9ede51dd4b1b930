//! Cycles of the solvers on the device's core, in an emulator.

use crate::support::{self, csv, number, stderr, stdout, summary};
use crate::{accuracy, json, short_scene};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

/// Returns whether the image for the target could not be built here; a line about it,
/// or a failure where it must be.
fn has_no_target(output: &Output) -> bool {
    let printed = stderr(output);
    let has_none = printed.contains("rustup target add thumbv7em-none-eabihf")
        || printed.contains("built without the emulator");
    if has_none {
        assert!(std::env::var_os("CREPITUS_NEEDS_TARGET").is_none());
        println!("left out: there is no image for the target");
    }
    has_none
}

#[test]
fn the_target_adds_cycles_to_points_summary_and_report() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "frozen");
    let out = home.path().join("study");
    let to = out.display();
    let output = accuracy(&format!(
        "--target --all --quick --steps 1e-4,5e-5 --scene {scene} --out {to}"
    ));
    if has_no_target(&output) {
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let label = "modelled cycles, 0 wait states; not measured on hardware";
    assert!(
        text.contains(label) && text.contains("| bone-shaping (motor) |"),
        "{text}"
    );

    let (header, rows) = csv(&out.join("points.csv"));
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let mut rungs = 0;
    for row in &rows {
        let cell = |name: &str| number(&row[column(name)]);
        let on_the_device = row[column("precision")] == "f32" && cell("step_s") == 5e-5;
        if on_the_device {
            rungs += 1;
            assert!(
                cell("instructions_per_step") < cell("cycles_per_step"),
                "{row:?}"
            );
            assert!(cell("cycles_per_step") < cell("worst_cycles"), "{row:?}");
            assert!(cell("worst_cycles") < 8_400.0, "{row:?}");
        } else {
            assert!(cell("cycles_per_step").is_nan(), "{row:?}");
        }
    }
    assert_eq!(rungs, 4);
    let target = &summary(&out)["target"];
    assert_eq!(target["label"], label);
    // Four rungs, the check, the renderer, the encoder, ten effects and four of them in
    // their other form, the current loop.
    assert_eq!(target["rows"].as_array().unwrap().len(), 22);
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("On the device’s core") || report.contains("On the device's core"));
    assert!(report.contains(label));
}

#[test]
fn the_record_is_what_the_target_does() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("study");
    let to = out.display();
    let output = accuracy(&format!("--target --steps 5e-5 --out {to}"));
    if has_no_target(&output) {
        return;
    }
    let record = support::repository().join("host/studies/src/accuracy/target/cycles.csv");
    let read = |file: &Path| fs::read_to_string(file).unwrap();
    assert_eq!(read(&out.join("cycles.csv")), read(&record));
}

#[test]
fn on_the_target_its_cycles_choose() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "frozen");
    let arguments = format!("--need torque=9e-3,frequency=1e-6 --target --quick --scene {scene}");
    let output = accuracy(&format!("--json {arguments}"));
    if has_no_target(&output) {
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = json(&output);
    assert_eq!(printed["chosen_by"], "target cycles");
    let answer = &printed["answer"];
    // As accurate as `exact-break`, and cheaper on the target whatever the
    // host says.
    let (chosen, runner_up) = (&answer["chosen"], &answer["runner_up"]);
    assert_eq!(chosen["solver"], "exact-interpolated");
    assert_eq!(chosen["step_s"], 5e-5);
    assert_eq!(runner_up["solver"], "exact-break");
    let mean = |candidate: &Value| candidate["cycles"]["mean"].as_f64().unwrap();
    assert!(mean(chosen) < mean(runner_up), "{answer}");
    assert!(chosen["cycles"]["worst"].as_f64().unwrap() <= 1_680.0);
    let failed: Vec<_> = answer["failed"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| &c["solver"])
        .collect();
    assert_eq!(failed, ["exact"]);
    let text = stdout(&accuracy(&arguments));
    for part in [
        "modelled cycles, 0 wait states; not measured on hardware",
        "must fit 20 % of a tick, 1680 cycles",
        "Use exact-interpolated with a step of 50 µs",
        "The runner-up is exact-break",
        "These fail:\n  exact, ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn without_the_target_it_reports_what_to_install() {
    let output = support::crepitus()
        .args(["accuracy", "--target", "--quick"])
        .env_remove("CREPITUS_IMAGES")
        .env("RUSTC", "no-such-compiler")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let printed = stderr(&output);
    assert!(
        printed.contains("rustup target add thumbv7em-none-eabihf"),
        "{printed}"
    );
}

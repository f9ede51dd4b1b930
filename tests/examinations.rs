//! The examinations that ship, on the simulated device: with `--arm --zero` the leg begins straight
//! and is led to where the motion begins, so that the device has the angles of the scene.
//!
//! `CREPITUS_LONG=1` examines to the end; without it, as far as each scene has something new.

mod support;

use crepitus_scene::{Overrides, Scene, shipped};
use std::path::Path;
use std::process::Stdio;
use support::{crepitus, recording, rows, run, stderr, stdout};

/// An examination, and how long it has something new, s.
type Examination = (&'static str, f64);

/// Examinations of the range, of rigidity and of roughness.
const OF_THE_JOINT: [Examination; 7] = [
    ("end-feel-capsular", 4.4),
    ("end-feel-hard", 1.6),
    ("end-feel-springy", 1.8),
    ("lead-pipe-examination", 1.2),
    ("cogwheel-examination", 1.3),
    ("texture-there-and-back", 1.2),
    ("crepitus-into-a-wall", 2.0),
];

/// Examinations of muscles.
const OF_MUSCLES: [Examination; 6] = [
    ("spasticity-tardieu", 5.4),
    ("spasticity-catch-angles", 1.7),
    ("spasticity-reflex", 5.4),
    ("clasp-knife-examination", 1.6),
    ("rigid-and-contracted", 1.2),
    ("catch-and-clonus", 4.5),
];

/// Time that ends before V3, s: at V3, 350 °/s, a device lets go.
const BEFORE_V3_S: f64 = 6.7;

fn scene(name: &str) -> Scene {
    shipped::scene(Path::new(name), &Overrides::default()).unwrap()
}

/// Time until the motion begins, s: arming, and a stroke of at most 30 °/s from 0°.
fn led_s(scene: &Scene) -> f64 {
    0.2 + 1.875 * scene.start().angle_rad.to_degrees() / 30.0
}

fn examine(examinations: &[Examination]) {
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    for (name, new_s) in examinations {
        let scene = scene(name);
        let examined_s = match *name {
            _ if !is_long => *new_s,
            "spasticity-tardieu" | "spasticity-reflex" => BEFORE_V3_S,
            _ => scene.duration_s,
        };
        let time = format!("{}s", led_s(&scene) + examined_s);
        let output = crepitus()
            .args(["arm", "--device", "sim", "--scene", name, "--zero", "--for"])
            .arg(time)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        assert_eq!(stdout(&output), "disarmed: the duration has elapsed\n");
    }
}

#[test]
fn examinations_of_the_joint_run_without_a_fault() {
    examine(&OF_THE_JOINT);
}

#[test]
fn examinations_of_muscles_run_without_a_fault() {
    examine(&OF_MUSCLES);
}

#[test]
fn a_stretch_that_is_held_beats() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("clonus");
    let name = "clonus-hold";
    let scene = scene(name);
    let led_s = led_s(&scene);
    // Until the hand lets go.
    let time = format!("{}s", led_s + 3.2);
    let device = ["--device", "sim", "--scene", name, "--arm", "--zero"];
    let record = ["record", file.to_str().unwrap(), "--for", &time];
    let output = run(&[&record[..], &device].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let rows = rows(&recording(&file));
    // Straight, then from 30° to 75°: the scene's own angles.
    let first_deg = rows[0].angle_rad.to_degrees();
    assert!(first_deg.abs() < 0.1, "{first_deg}");
    let held_deg = rows[rows.len() - 1].angle_rad.to_degrees();
    assert!((held_deg - 75.0).abs() < 0.1, "{held_deg}");
    let beats = rows.windows(2).filter(|pair| {
        let mut phases = pair[1].phases.named();
        let is_beating = phases.any(|(spec, phase)| spec.name == "clonus" && phase == "beating");
        is_beating && pair[0].model_torque_nm == 0.0 && pair[1].model_torque_nm != 0.0
    });
    let beats: Vec<f64> = beats.map(|pair| pair[1].time_s).collect();
    assert!((15..=20).contains(&beats.len()), "{beats:?}");
    // Nothing on the slow way to 30°.
    assert!(beats[0] > led_s, "{beats:?}");
}

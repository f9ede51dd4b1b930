//! `crepitus fit` on tables of a knee that this file moves, and `crepitus identify` on a table.

// Counts become numbers; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

mod support;

use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use support::{refuses, run, stderr, stdout};

const STEP_S: f64 = 4e-3;

/// A knee that is bent and straightened at these speeds, deg/s: time, s, angle and velocity, rad and rad/s.
fn moved(speeds: &[f64]) -> Vec<[f64; 3]> {
    let mut rows = Vec::new();
    let (low, way) = (10_f64.to_radians(), 80_f64.to_radians());
    let hold = |rows: &mut Vec<[f64; 3]>, angle: f64| {
        for _ in 0..120 {
            rows.push([rows.len() as f64 * STEP_S, angle, 0.0]);
        }
    };
    hold(&mut rows, low);
    for speed in speeds {
        for sense in [1.0, -1.0] {
            let lasts = 1.875 * way / speed.to_radians();
            let from = if sense > 0.0 { low } else { low + way };
            let mut t = 0.0;
            while t < lasts {
                let x = t / lasts;
                let angle = from + sense * way * x.powi(3) * (10.0 + x * (6.0 * x - 15.0));
                let omega = sense * way / lasts * 30.0 * x * x * (1.0 - x).powi(2);
                rows.push([rows.len() as f64 * STEP_S, angle, omega]);
                t += STEP_S;
            }
            hold(&mut rows, from + sense * way);
        }
    }
    rows
}

/// Torque of a leg whose friction turns round over two degrees, N·m.
fn rigid(rows: &[[f64; 3]], friction_nm: f64) -> Vec<f64> {
    let mut random = fastrand::Rng::with_seed(3);
    let (mut share, mut before) = (0.0, rows[0][1]);
    let torque = rows.iter().map(|[_, angle, omega]| {
        share = f64::clamp(share + (angle - before) / 2_f64.to_radians(), -1.0, 1.0);
        before = *angle;
        6.0 * angle.cos() + 0.1 * omega + friction_nm * share + 0.05 * (random.f64() - 0.5)
    });
    torque.collect()
}

const SPEEDS: [f64; 5] = [30.0, 60.0, 120.0, 200.0, 90.0];

fn write(folder: &Path, name: &str, header: &str, rows: impl Iterator<Item = [f64; 3]>) -> String {
    let mut text = format!("{header}\n");
    for [a, b, c] in rows {
        writeln!(text, "{a:.6},{b:.6},{c:.6}").unwrap();
    }
    let file = folder.join(name);
    fs::write(&file, text).unwrap();
    file.to_str().unwrap().to_owned()
}

fn fitted(arguments: &[&str]) -> Value {
    let done = run(&[&["--json", "fit"], arguments].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
    printed["fit"].clone()
}

#[test]
fn a_rigid_knee_is_proposed_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let rows = moved(&SPEEDS);
    let torque = rigid(&rows, 1.3);
    let together = || rows.iter().zip(&torque);
    let usual = together().map(|([t, angle, _], nm)| [*t, *angle, *nm]);
    let usual = write(folder.path(), "knee.csv", "t_s,angle_rad,torque_nm", usual);
    let (out, scene) = (folder.path().join("out"), folder.path().join("knee.toml"));
    let [out, scene] = [&out, &scene].map(|path| path.to_str().unwrap());
    let done = run(&["fit", &usual, "--out", out, "--scene-out", scene]);
    assert!(done.status.success(), "{}", stderr(&done));
    let text = stdout(&done);
    assert!(
        text.contains("lead-pipe rigidity") && text.contains("updrs-2-lead-pipe"),
        "{text}"
    );
    let ran = run(&[
        "run",
        scene,
        "--no-trace",
        "--out",
        folder.path().join("run").to_str().unwrap(),
    ]);
    assert!(ran.status.success(), "{}", stderr(&ran));
    // As an isokinetic machine writes it: ms, extension in degrees from a right angle, foot-pounds.
    let pounds = together()
        .map(|([t, angle, _], nm)| [1e3 * t, 90.0 - angle.to_degrees(), nm / 1.355_817_948]);
    let pounds = write(
        folder.path(),
        "isokinetic.csv",
        "Time,Position,Moment",
        pounds,
    );
    let columns = [
        "--time",
        "Time",
        "--time-unit",
        "ms",
        "--angle",
        "Position",
        "--angle-scale",
        "-1",
    ];
    let units = [
        "--angle-offset",
        "90",
        "--torque",
        "Moment",
        "--torque-unit",
        "ft-lb",
    ];
    let [one, other] = [
        fitted(&[&usual]),
        fitted(&[&[&pounds[..]], &columns[..], &units].concat()),
    ];
    let torque = |fit: &Value| fit["proposed"]["values"][0]["value"].as_f64().unwrap();
    assert!(
        (torque(&one) - 1.3).abs() < 0.05 && (torque(&one) - torque(&other)).abs() < 0.01,
        "{one} {other}"
    );
    assert_eq!(one["grade"]["preset"], "updrs-2-lead-pipe");
}

#[test]
fn a_leg_that_is_let_go_of_needs_no_torque() {
    let folder = tempfile::tempdir().unwrap();
    let (mut angle, mut omega) = (20_f64.to_radians(), 0.0_f64);
    let rows = (0..1700).map(|row| {
        // Held, then free.
        for _ in 0..if row < 200 { 0 } else { 8 } {
            omega += STEP_S / 8.0 * (11.0 * angle.cos() - 0.15 * omega) / 0.35;
            angle += STEP_S / 8.0 * omega;
        }
        [f64::from(row) * STEP_S, angle.to_degrees(), 0.0]
    });
    let file = write(
        folder.path(),
        "pendulum.csv",
        "time,knee_flexion,none",
        rows,
    );
    let fit = fitted(&[&file, "--released-kg-m2", "0.35"]);
    assert_eq!(fit["proposed"]["symptom"], "no symptom", "{fit}");
}

#[test]
fn what_cannot_be_told_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let slow = moved(&[25.0, 30.0, 28.0, 30.0]);
    let torque = rigid(&slow, 0.05);
    let rows = slow
        .iter()
        .zip(&torque)
        .map(|([t, angle, _], nm)| [*t, *angle, *nm]);
    let file = write(folder.path(), "slow.csv", "t_s,angle_rad,torque_nm", rows);
    let fit = fitted(&[&file]);
    assert_eq!(fit["proposed"]["symptom"], "no symptom");
    let untold = fit["cannot_be_told"].to_string();
    assert!(
        untold.contains("clonus") && untold.contains("90 on"),
        "{untold}"
    );
    let once = moved(&[60.0]);
    let rows = once.iter().map(|[t, angle, _]| [*t, *angle, 1.0]);
    let once = write(folder.path(), "once.csv", "t_s,angle_rad,torque_nm", rows);
    refuses(&["fit", &once], 1, "2 strokes were found");
    let mut random = fastrand::Rng::with_seed(1);
    let rows: Vec<[f64; 3]> = slow
        .iter()
        .map(|[t, angle, _]| [*t, *angle, random.f64()])
        .collect();
    let noise = write(
        folder.path(),
        "noise.csv",
        "t_s,angle_rad,torque_nm",
        rows.into_iter(),
    );
    refuses(&["fit", &noise], 1, "the torque is noise");
    refuses(&["fit", &file, "--torque", "force"], 2, "--torque");
    refuses(&["fit", &file, "--angle-scale", "0"], 2, "other than 0");
}

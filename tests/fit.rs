//! `crepitus fit` on tables of a knee that this file moves.

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
    let measured = rigid(&rows, 1.3);
    let together = rows.iter().zip(&measured);
    let usual = together.map(|([t, angle, _], nm)| [*t, *angle, *nm]);
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
    let fit = fitted(&[&usual]);
    assert!((torque(&fit) - 1.3).abs() < 0.05, "{fit}");
    assert_eq!(fit["grade"]["preset"], "updrs-2-lead-pipe");
}

fn torque(fit: &Value) -> f64 {
    fit["proposed"]["values"][0]["value"].as_f64().unwrap()
}

/// A file as a machine writes it, and what has to be said of it.
struct Export {
    name: &'static str,
    head: &'static str,
    separator: &'static str,
    has_commas: bool,
    /// Columns of time, s, angle, rad, and torque, N·m.
    columns: fn([f64; 3]) -> [f64; 3],
    arguments: &'static [&'static str],
    /// Words on standard error.
    said: &'static str,
}

const FOOT_POUND_NM: f64 = 1.355_817_948;

const EXPORTS: [Export; 5] = [
    Export {
        name: "isokinetic.csv",
        head: "Time,Position,Moment",
        separator: ",",
        has_commas: false,
        columns: |[t, angle, nm]| [1e3 * t, 90.0 - angle.to_degrees(), nm / FOOT_POUND_NM],
        arguments: &[
            "--time-unit",
            "ms",
            "--angle-scale",
            "-1",
            "--angle-offset",
            "90",
            "--torque-unit",
            "ft-lb",
        ],
        said: "",
    },
    Export {
        name: "dynamometer.txt",
        head: "Isokinetic report\nParticipant: P07\nSide: right\n\n   Time     Torque   Position\n   mSec   FT-LBS    Degrees",
        separator: "   ",
        has_commas: false,
        columns: |[t, angle, nm]| [1e3 * t, nm / FOOT_POUND_NM, angle.to_degrees()],
        arguments: &[],
        said: "torques are in ft-lb",
    },
    Export {
        name: "german.csv",
        head: "Zeit (s);Winkel (°);Drehmoment (Nm)",
        separator: ";",
        has_commas: true,
        columns: |[t, angle, nm]| [t, angle.to_degrees(), nm],
        arguments: &[],
        said: "decimal commas",
    },
    Export {
        name: "by-name.tsv",
        head: "TIME (ms)\tKNEE_ANGLE_RAD\tTorque [in-lb]",
        separator: "\t",
        has_commas: false,
        columns: |[t, angle, nm]| [1e3 * t, angle, nm / 0.112_984_829],
        arguments: &[],
        said: "in rad, as the name of the column says",
    },
    // A force sensor 0.3 m from the axis, positive against extension.
    Export {
        name: "force.csv",
        head: "t_s,knee_flexion_deg,force_n",
        separator: ",",
        has_commas: false,
        columns: |[t, angle, nm]| [t, angle.to_degrees(), -nm / 0.3],
        arguments: &["--torque", "force_n", "--torque-scale", "-0.3"],
        said: "",
    },
];

#[test]
fn files_of_machines_are_read_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let rows = moved(&SPEEDS);
    let measured = rigid(&rows, 1.3);
    for export in EXPORTS {
        let mut text = format!("{}\n", export.head);
        for ([t, angle, _], nm) in rows.iter().zip(&measured) {
            let cells = (export.columns)([*t, *angle, *nm]).map(|x| format!("{x:.6}"));
            let line = cells.join(export.separator);
            text += &if export.has_commas {
                line.replace('.', ",")
            } else {
                line
            };
            text.push('\n');
        }
        let file = folder.path().join(export.name);
        fs::write(&file, text).unwrap();
        let arguments = [&["--json", "fit", file.to_str().unwrap()], export.arguments].concat();
        let done = run(&arguments);
        let said = stderr(&done);
        assert!(
            done.status.success() && said.contains(export.said),
            "{}: {said}",
            export.name
        );
        let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
        let torque = torque(&printed["fit"]);
        assert!((torque - 1.3).abs() < 0.05, "{}: {torque}", export.name);
    }
}

#[test]
fn files_that_are_no_examination_say_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let rows = moved(&SPEEDS);
    let torque = rigid(&rows, 1.3);
    let lines: Vec<String> = (rows.iter().zip(&torque))
        .map(|([t, angle, _], nm)| format!("{t:.4},{angle:.5},{nm:.4}"))
        .collect();
    let file = |name: &str, head: &str, lines: &[String]| {
        let file = folder.path().join(name);
        fs::write(&file, format!("{head}\n{}\n", lines.join("\n"))).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let empty = folder.path().join("empty.csv");
    fs::write(&empty, "").unwrap();
    refuses(&["fit", empty.to_str().unwrap()], 2, "is empty");
    refuses(&["fit", folder.path().to_str().unwrap()], 2, "folder");
    let usual = "t_s,angle_rad,torque_nm";
    refuses(&["fit", &file("two.csv", usual, &lines[..2])], 2, "rows");
    let unnamed = file("unnamed.csv", "t_s,angle_rad,load", &lines);
    refuses(
        &["fit", &unnamed],
        2,
        "name it with --torque, or give --released-kg-m2",
    );
    refuses(&["fit", &unnamed, "--torque", "loads"], 2, "load");
    let mut broken = lines.clone();
    broken[700] = "2.8000,0.31,NaN".to_owned();
    refuses(&["fit", &file("nan.csv", usual, &broken)], 2, "line 702");
    // Radians that are taken for degrees, the other way round, and milliseconds for seconds.
    let small = file("small.csv", "t_s,angle,torque_nm", &lines);
    refuses(&["fit", &small], 1, "are the angle's column and unit right");
    let degrees: Vec<String> = (rows.iter().zip(&torque))
        .map(|([t, angle, _], nm)| format!("{t:.4},{:.3},{nm:.4}", angle.to_degrees()))
        .collect();
    let degrees = file("degrees.csv", "t_s,angle,torque_nm", &degrees);
    refuses(&["fit", &degrees, "--unit", "rad"], 2, "rad");
    refuses(
        &["fit", &small, "--unit", "rad", "--time-unit", "ms"],
        1,
        "strokes",
    );
    let weighed = file("kilograms.csv", "t_s,angle_rad,torque (kgf m)", &lines);
    refuses(&["fit", &weighed], 2, "--torque-unit");
}

#[test]
fn a_leg_that_is_let_go_of_needs_no_torque() {
    let folder = tempfile::tempdir().unwrap();
    let (mut angle, mut omega) = (20_f64.to_radians(), 0.0_f64);
    let rows = (0..1700).map(|row| {
        // Lifted and held by a hand, then free.
        if row < 100 {
            let lifted = 90.0 - 0.7 * f64::from(row);
            return [f64::from(row) * STEP_S, lifted, 0.0];
        }
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
    let share = fit["unexplained"]["share"].as_f64().unwrap();
    assert!(share < 0.01, "{share}");
}

/// A leg with the inertia and the weight of the public pendulum test of Neuromechanics-Lab/PenGulum, by a camera of
/// 100 Hz in tenths of a degree: the noise of its acceleration is no rigidity.
#[test]
fn a_pendulum_test_by_a_camera_has_no_symptom() {
    let folder = tempfile::tempdir().unwrap();
    let (mut angle, mut omega) = (0.0_f64, 0.0_f64);
    let mut text = "Time [s];Knee angle [deg]\n".to_owned();
    for row in 0..900 {
        for _ in 0..if row < 60 { 0 } else { 20 } {
            let friction = 0.35 * omega + 0.1 * (omega / 0.01).clamp(-1.0, 1.0);
            omega += 5e-4 * (12.43 * angle.cos() - friction) / 0.4455;
            angle += 5e-4 * omega;
        }
        writeln!(
            text,
            "{:.2};{:.1}",
            0.01 * f64::from(row),
            angle.to_degrees()
        )
        .unwrap();
    }
    let file = folder.path().join("camera.csv");
    fs::write(&file, text).unwrap();
    let fit = fitted(&[file.to_str().unwrap(), "--released-kg-m2", "0.4455"]);
    assert_eq!(fit["proposed"]["symptom"], "no symptom", "{fit}");
    // A squat is no leg that was let go of.
    let mut squat = "time,knee_flexion\n".to_owned();
    for row in 0..900 {
        let t = 0.01 * f64::from(row);
        let deg = 45.0 - 40.0 * (2.0 * t).cos() + 8.0 * (5.3 * t).sin();
        writeln!(squat, "{t:.2},{deg:.2}").unwrap();
    }
    fs::write(&file, squat).unwrap();
    let file = file.to_str().unwrap();
    refuses(&["fit", file, "--released-kg-m2", "0.4"], 1, "explain");
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
    refuses(
        &["fit", &file, "--torque", "force"],
        2,
        "there is no such column",
    );
    refuses(&["fit", &file, "--angle-scale", "0"], 2, "other than 0");
}

//! `crepitus accuracy` as a person or a script uses it.

#[path = "../support/mod.rs"]
mod support;
mod target;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::{csv, names, number, run, stderr, stdout, summary};

/// A scene of half a second: long enough for a few dozen events.
fn short_scene(folder: &Path, convention: &str) -> PathBuf {
    let file = folder.join(format!("short-{convention}.toml"));
    let text = format!(
        "version = 1\ntitle = \"short\"\nduration_s = 0.5\n\
         [motion]\nkind = \"constant\"\nvelocity_rad_s = 0.988\n\
         [solver]\nkind = \"exact\"\nstep_s = 5e-5\n\
         [effects.crepitus]\nconvention = \"{convention}\"\n"
    );
    fs::write(&file, text).unwrap();
    file
}

fn accuracy(arguments: &[&str]) -> Output {
    run(&[&["accuracy"], arguments].concat())
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&stdout(output)).expect("JSON")
}

#[test]
fn a_study_becomes_three_files() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let out = home.path().join("study");
    let output = accuracy(&[
        "--quick",
        "--scene",
        scene.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(names(&out), ["points.csv", "report.html", "summary.json"]);
    let text = stdout(&output);
    assert!(
        text.contains("50 µs") && text.contains("rk4-events"),
        "{text}"
    );
    assert!(text.contains("report.html"), "{text}");
    assert!(text.lines().count() <= 25, "{text}");
    let answer = text.split("\n\n").next().unwrap().replace('\n', " ");
    for part in [
        "At the device's tick of 50 µs (physical, f32, worst of one scene) the cheapest solver, ",
        "; exact events take ",
        "On the controller: ",
        "(modelled cycles, 0 wait states; not measured on hardware)",
        "A torque that is held for 50 µs is off by ",
    ] {
        assert!(answer.contains(part), "{part}: {text}");
    }

    let (header, rows) = csv(&out.join("points.csv"));
    assert_eq!(
        header.join(","),
        "scene,convention,solver,precision,step_s,events,events_true,unmatched,\
         max_event_error_s,rms_event_error_s,max_interval_error_s,frequency_error_rel,\
         rms_held_torque_error_nm,max_held_torque_error_nm,held_floor_nm,\
         rms_tick_torque_error_nm,max_tick_torque_error_nm,behind_s,behind_j,ns_per_step,us_per_simulated_s,\
         time_spread,cycles_per_step,worst_cycles,instructions_per_step"
    );
    // Ten rungs in two precisions, one in f64 alone, five steps.
    assert_eq!(rows.len(), 105);
    for row in &rows {
        assert_eq!(row.len(), header.len());
        assert_eq!(row[..2], ["short-physical", "physical"]);
        for cell in &row[4..] {
            number(cell);
        }
        // No rung continues a slip after its end.
        assert_eq!(row[17..19], ["0.0", "0.0"], "{row:?}");
        assert!(number(&row[19]) > 0.0, "{row:?}");
        let per_second = number(&row[19]) * 1e-3 / number(&row[4]);
        assert!((number(&row[20]) / per_second - 1.0).abs() < 1e-9);
    }
    let exact = rows
        .iter()
        .find(|r| r[2..4] == ["exact-events", "f64"] && number(&r[4]) == 5e-5)
        .expect("the device's tick is studied");
    assert_eq!((exact[5].as_str(), exact[7].as_str()), ("31", "0"));
    assert!(number(&exact[8]) < 1e-13 && number(&exact[15]) < 1e-10);
    // Exact at the ticks, and off by 8 mN·m for being held between them.
    let (held, floor) = (number(&exact[12]), number(&exact[14]));
    assert!((held - 8e-3).abs() < 2e-4, "{held}");
    assert!((held / floor - 3_f64.sqrt()).abs() < 0.05, "{floor}");

    let summary = summary(&out);
    assert_eq!(summary["scenes"][0]["events_true"], 31);
    assert_eq!(summary["points"], 105);
    assert!(summary["wall_s"].as_f64().unwrap() > 0.0);
    let orders = summary["orders"].as_array().unwrap();
    let order = |solver: &str| {
        let of = orders.iter().find(|o| o["solver"] == solver).unwrap();
        of["frequency"].clone()
    };
    assert_eq!(order("exact-events")["kind"], "round-off");
    let fourth = order("rk4-events")["order"].as_f64().unwrap();
    assert!((fourth - 4.0).abs() < 0.5, "{fourth}");

    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.len() < 5_000_000);
    assert!(!report.contains("http://") && !report.contains("https://"));
}

#[test]
fn what_has_no_meaning_is_listed_with_its_reason() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "frozen");
    let out = home.path().join("study");
    let output = accuracy(&[
        "--json",
        "--steps",
        "1e-3,1",
        "--scene",
        scene.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = json(&output);
    let refused = printed["summary"]["refused"].as_array().unwrap();
    assert!(refused.iter().any(|r| r["solver"] == "rk4"));
    for refused in refused {
        assert_eq!(refused["convention"], "frozen");
        assert!(refused["reason"].as_str().unwrap().len() > 20);
    }
    let skipped = &printed["summary"]["skipped"][0];
    assert_eq!(skipped["step_s"], 1.0);
    let (_, rows) = csv(&out.join("points.csv"));
    assert!(!rows.is_empty() && rows.iter().all(|r| r[2] != "rk4"));
}

/// Errors of a rung in f32 at a step, measured again: held torque, interval,
/// unmatched.
fn measured_again(scene: &Path, solver: &str, step: &str) -> (f64, f64, f64) {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("again");
    let output = accuracy(&[
        "--steps",
        step,
        "--scene",
        scene.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (_, rows) = csv(&out.join("points.csv"));
    let row = rows
        .iter()
        .find(|r| r[2] == solver && r[3] == "f32")
        .expect("its point");
    (number(&row[12]), number(&row[10]), number(&row[7]))
}

#[test]
fn a_need_gets_the_cheapest_that_meets_it() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let scene_name = scene.to_str().unwrap();
    let (torque, interval) = (9e-3, 2e-5);
    let arguments = [
        "--need",
        "torque=9e-3,interval=2e-5",
        "--rate",
        "20000",
        "--quick",
        "--scene",
        scene_name,
    ];
    let output = accuracy(&[&["--json"], &arguments[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = json(&output);
    let answer = &printed["answer"];
    let chosen = &answer["chosen"];
    let solver = chosen["solver"].as_str().unwrap();
    assert_eq!(chosen["step_s"], 5e-5);
    let (t, i, unmatched) = measured_again(&scene, solver, "5e-5");
    assert!(
        t <= torque && i <= interval && unmatched == 0.0,
        "{solver}: {t} {i} {unmatched}"
    );
    // Cheaper solvers fail.
    let cheaper = answer["cheaper"].as_array().unwrap();
    for cheaper in cheaper {
        let solver = cheaper["solver"].as_str().unwrap();
        assert!(cheaper["us_per_simulated_s"].as_f64() < chosen["us_per_simulated_s"].as_f64());
        let (t, i, unmatched) = measured_again(&scene, solver, "5e-5");
        assert!(
            t > torque || i > interval || unmatched > 0.0,
            "{solver}: {t} {i} {unmatched}"
        );
    }
    // Every rung without location is a step late.
    assert_ne!(solver, "exact");
    assert!(!home.path().join("out").exists());

    let output = accuracy(&arguments);
    let text = stdout(&output);
    assert!(
        text.contains("Use ") && text.contains("% of one core"),
        "{text}"
    );
    assert!(text.contains("of the limit"), "{text}");
}

#[test]
fn without_a_rate_the_longest_steps_are_printed() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let output = accuracy(&[
        "--need",
        "frequency=1e-6",
        "--precision",
        "f64",
        "--all",
        "--quick",
        "--scene",
        scene.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let line = |solver: &str| {
        text.lines()
            .find(|l| l.trim_start().starts_with(&format!("{solver} ")))
            .unwrap_or_else(|| panic!("{solver} is missing: {text}"))
            .to_owned()
    };
    assert!(line("exact-events").contains("1000 µs"), "{text}");
    assert!(line("implicit-euler").contains("never"), "{text}");
    assert!(text.contains("Why not a cheaper one"), "{text}");
}

#[test]
fn a_need_that_nothing_meets_fails_with_the_nearest() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "frozen");
    let arguments = [
        "--need",
        "event=1e-30",
        "--quick",
        "--scene",
        scene.to_str().unwrap(),
    ];
    let output = accuracy(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let text = stdout(&output);
    assert!(text.contains("Nothing studied meets it"), "{text}");
    assert!(text.contains("times the limit"), "{text}");
    let output = accuracy(&[&["--json"], &arguments[..]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(json(&output)["answer"]["chosen"].is_null());
}

#[test]
fn a_torque_that_cannot_be_held_is_reported_and_can_be_requested_at_the_tick() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let ask = |need| {
        let scene = scene.to_str().unwrap();
        accuracy(&[
            "--need", need, "--rate", "20000", "--quick", "--scene", scene,
        ])
    };
    let output = ask("torque=4e-3");
    assert_eq!(output.status.code(), Some(1));
    let text = stdout(&output);
    assert!(
        text.contains("rms error of the held torque at most 4e-3 N·m"),
        "{text}"
    );
    assert!(
        text.contains("No solver could: any torque that is held for 50 µs is off by 4.6e-3"),
        "{text}"
    );
    // Between the floor and what solvers reach it is only not met.
    let text = stdout(&ask("torque=5e-3"));
    assert!(
        text.contains("Nothing studied meets it") && !text.contains("No solver could"),
        "{text}"
    );
    let output = ask("torque-at-tick=4e-3");
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    assert!(stdout(&output).contains("rms torque error at the tick"));
}

#[test]
fn bad_usage_gives_the_valid_values() {
    let home = tempfile::tempdir().unwrap();
    let frozen = short_scene(home.path(), "frozen");
    let frozen = frozen.to_str().unwrap();
    for (arguments, part) in [
        (vec!["--need", "torque"], "KEY=VALUE"),
        (vec!["--need", "speed=1"], "peak-torque"),
        (vec!["--need", "torque=-1"], "above 0"),
        (
            vec!["--need", "torque=1", "--rate", "-5"],
            "from 10 to 1e6 Hz",
        ),
        (vec!["--need", "torque=1", "--rate", "fast"], "fast"),
        (vec!["--need", "torque=1", "--precision", "f16"], "f32, f64"),
        (
            vec!["--need", "torque=1", "--convention", "dry"],
            "frozen, paper, physical",
        ),
        (
            vec![
                "--need",
                "torque=1",
                "--convention",
                "paper",
                "--scene",
                frozen,
            ],
            "this scene is studied under frozen",
        ),
        (
            vec!["--need", "torque=1", "--target", "--rate", "10000"],
            "expected --rate 20000 or no --rate",
        ),
        (
            vec!["--need", "torque=1", "--target", "--precision", "f64"],
            "the target computes in f32",
        ),
        (vec!["--rate", "20000"], "--need"),
        (vec!["--scene", "no-such-scene"], "no such scene ships"),
        (vec!["--scene", "presliding", "--steps", "0"], "1e-7 to 1 s"),
    ] {
        let output = accuracy(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            stderr(&output).contains(part),
            "{arguments:?}: {}",
            stderr(&output)
        );
        assert_eq!(stdout(&output), "", "{arguments:?}");
    }
}

#[test]
fn a_scene_without_events_is_studied_too() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("still");
    let output = accuracy(&[
        "--scene",
        "presliding",
        "--steps",
        "1e-3",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (header, rows) = csv(&out.join("points.csv"));
    let tick = header.iter().position(|h| h == "rms_tick_torque_error_nm");
    // Four rungs in two precisions, one step.
    assert_eq!(rows.len(), 8);
    for row in &rows {
        assert_eq!(row[5..8], ["0", "0", "0"], "{row:?}");
        assert_eq!(row[8], "nan");
        assert!(number(&row[tick.unwrap()]) < 1e-3, "{row:?}");
    }
}

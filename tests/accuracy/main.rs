//! `crepitus accuracy` as a person or a script uses it.

#[path = "../support/mod.rs"]
mod support;
mod target;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;
use support::{csv, done, names, number, run_line, stderr, stdout, summary};

/// A scene of half a second: long enough for a few dozen events.
fn short_scene(folder: &Path, convention: &str) -> String {
    let file = folder.join(format!("short-{convention}.toml"));
    let text = format!(
        "version = 1\ntitle = \"short\"\nduration_s = 0.5\n\
         [motion]\nkind = \"constant\"\nvelocity_rad_s = 0.988\n\
         [solver]\nkind = \"exact\"\nstep_s = 5e-5\n\
         [effects.crepitus]\nconvention = \"{convention}\"\n"
    );
    fs::write(&file, text).unwrap();
    file.display().to_string()
}

fn accuracy(arguments: &str) -> Output {
    run_line(&format!("accuracy {arguments}"))
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&stdout(output)).expect("JSON")
}

#[test]
fn a_study_becomes_three_files() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let out = home.path().join("study");
    let to = out.display();
    let text = done(&format!("accuracy --quick --scene {scene} --out {to}"));
    assert_eq!(names(&out), ["points.csv", "report.html", "summary.json"]);
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
        "scene,convention,input,solver,precision,step_s,events,events_true,unmatched,\
         max_event_error_s,rms_event_error_s,max_interval_error_s,frequency_error_rel,\
         rms_held_torque_error_nm,max_held_torque_error_nm,held_floor_nm,\
         rms_tick_torque_error_nm,max_tick_torque_error_nm,behind_s,behind_j,ns_per_step,ns_per_step_q1,ns_per_step_q3,us_per_simulated_s,\
         time_spread,cycles_per_step,worst_cycles,instructions_per_step,host_instructions_per_step"
    );
    // Ten rungs in two precisions, one in f64 alone, five steps.
    assert_eq!(rows.len(), 105);
    let summary = summary(&out);
    assert_eq!(summary["scenes"][0]["events_true"], 31);
    assert_eq!(summary["points"], 105);
    let machine = &summary["machine"];
    assert!(machine["compiler"].as_str().unwrap().starts_with("rustc "));
    for key in ["cpu", "system", "target", "opt_level", "target_features"] {
        assert!(!machine[key].as_str().unwrap().is_empty(), "{key}");
    }
    let at = |name: &str| header.iter().position(|column| column == name).unwrap();
    let [first, median, third] = ["ns_per_step_q1", "ns_per_step", "ns_per_step_q3"].map(at);
    let counted = text.contains("Instructions are valgrind's");
    assert_eq!(
        text.contains("Instructions were not counted"),
        !counted,
        "{text}"
    );
    for row in &rows {
        let count = number(&row[at("host_instructions_per_step")]);
        let is_tick = number(&row[at("step_s")]) == 5e-5;
        assert_eq!(count.is_finite(), counted && is_tick, "{row:?}");
        assert!(
            count.is_nan() || (5.0..=5_000.0).contains(&count),
            "{row:?}"
        );
        assert_eq!(row[at("input")], "exact");
        let [first, median, third] = [first, median, third].map(|column| number(&row[column]));
        assert!(first <= median && median <= third, "{row:?}");
        let spread = number(&row[at("time_spread")]);
        assert!(((third - first) / median - spread).abs() < 1e-12, "{row:?}");
    }
    assert!(summary["wall_s"].as_f64().unwrap() > 0.0);
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.len() < 5_000_000);
    assert!(!report.contains("http://") && !report.contains("https://"));
}

#[test]
fn what_has_no_meaning_is_listed_with_its_reason() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "frozen");
    let out = home.path().join("study");
    let to = out.display();
    let line = format!("--json --steps 1e-3,1 --scene {scene} --out {to}");
    let printed = json(&accuracy(&line));
    let refused = printed["summary"]["refused"].as_array().unwrap();
    assert!(refused.iter().any(|r| r["solver"] == "rk4"));
    for refused in refused {
        assert_eq!(refused["convention"], "frozen");
        assert!(refused["reason"].as_str().unwrap().len() > 20);
    }
    let skipped = &printed["summary"]["skipped"][0];
    assert_eq!(skipped["step_s"], 1.0);
    let (_, rows) = csv(&out.join("points.csv"));
    assert!(!rows.is_empty() && rows.iter().all(|r| r[3] != "rk4"));
}

#[test]
fn a_need_gets_the_cheapest_that_meets_it() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let arguments =
        format!("--need torque=9e-3,interval=2e-5 --rate 20000 --quick --scene {scene}");
    let printed = json(&accuracy(&format!("--json {arguments}")));
    let answer = &printed["answer"];
    let chosen = &answer["chosen"];
    let solver = chosen["solver"].as_str().unwrap();
    assert_eq!(chosen["step_s"], 5e-5);
    // Every rung without location is a step late.
    assert_ne!(solver, "exact");
    assert!(!home.path().join("out").exists());

    let text = done(&format!("accuracy {arguments}"));
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
    let need = "--need frequency=1e-6 --precision f64";
    let text = done(&format!("accuracy {need} --all --quick --scene {scene}"));
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
fn a_torque_that_cannot_be_held_is_reported_and_can_be_requested_at_the_tick() {
    let home = tempfile::tempdir().unwrap();
    let scene = short_scene(home.path(), "physical");
    let ask = |need| {
        accuracy(&format!(
            "--need {need} --rate 20000 --quick --scene {scene}"
        ))
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
    let with_scene = format!("--need torque=1 --convention paper --scene {frozen}");
    for (arguments, part) in [
        ("--need torque", "KEY=VALUE"),
        ("--need speed=1", "peak-torque"),
        ("--need torque=-1", "above 0"),
        ("--need torque=1 --rate -5", "from 10 to 1e6 Hz"),
        ("--need torque=1 --rate fast", "fast"),
        ("--need torque=1 --precision f16", "f32, f64"),
        (
            "--need torque=1 --convention dry",
            "frozen, paper, physical",
        ),
        (&with_scene, "this scene is studied under frozen"),
        (
            "--need torque=1 --target --rate 10000",
            "expected --rate 20000 or no --rate",
        ),
        (
            "--need torque=1 --target --precision f64",
            "the target computes in f32",
        ),
        ("--rate 20000", "--need"),
        ("--scene no-such-scene", "no such scene ships"),
        ("--scene presliding --steps 0", "1e-7 to 1 s"),
    ] {
        let output = accuracy(arguments);
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
    let to = out.display();
    done(&format!(
        "accuracy --scene presliding --steps 1e-3 --out {to}"
    ));
    let (header, rows) = csv(&out.join("points.csv"));
    let tick = header.iter().position(|h| h == "rms_tick_torque_error_nm");
    // Four rungs in two precisions, one step.
    assert_eq!(rows.len(), 8);
    for row in &rows {
        assert_eq!(row[6..9], ["0", "0", "0"], "{row:?}");
        assert_eq!(row[9], "nan");
        assert!(number(&row[tick.unwrap()]) < 1e-3, "{row:?}");
    }
}

/// Bends of a knee as a camera sees them, and recorded knees where they stand beside the repository.
#[test]
fn a_recording_is_studied_with_its_cost() {
    let home = tempfile::tempdir().unwrap();
    let lines = (0..=200).map(|n| {
        let t_s = f64::from(n) * 0.01;
        let angle_deg = 35.0 - 30.0 * (4.0 * t_s).cos() + (12.0 * t_s).sin();
        format!("{t_s},{angle_deg}\n")
    });
    let bends = home.path().join("bends.csv");
    let table = format!("time_s,knee_flexion_deg\n{}", lines.collect::<String>());
    fs::write(&bends, table).unwrap();
    let recorded = support::repository().join("../shared/data");
    let mut files = vec![bends];
    files.extend(["opensim_walk_100hz.csv", "opencap_squat_100hz.csv"].map(|f| recorded.join(f)));
    for file in files.iter().filter(|file| file.is_file()) {
        let scene = home.path().join("knee.toml");
        let text = format!(
            "version = 1\ntitle = \"knee\"\nduration_s = 1.9\n[motion]\nkind = \"recording\"\n\
             file = {file:?}\ntime_column = \"time_s\"\nangle_column = \"knee_flexion_deg\"\n\
             [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n[effects.crepitus]\n"
        );
        fs::write(&scene, text).unwrap();
        let out = home.path().join(file.file_stem().unwrap());
        let (scene, to) = (scene.display(), out.display());
        done(&format!("accuracy --scene {scene} --steps 5e-5 --out {to}"));
        let (header, rows) = csv(&out.join("points.csv"));
        let column = |name: &str| header.iter().position(|h| h == name).unwrap();
        let is_ours = |row: &&Vec<String>| {
            row[column("solver")] == "exact-events" && row[column("precision")] == "f32"
        };
        let row = rows.iter().find(is_ours).unwrap();
        let of = |name: &str| number(&row[column(name)]);
        assert!(
            of("events_true") > 20.0 && of("unmatched") == 0.0,
            "{row:?}"
        );
        assert!(of("rms_event_error_s") < 1e-5, "{row:?}");
        let [low, median, high] = ["ns_per_step_q1", "ns_per_step", "ns_per_step_q3"].map(of);
        assert!(0.0 < low && low <= median && median <= high, "{row:?}");
    }
}

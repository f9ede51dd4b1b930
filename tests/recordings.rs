//! `crepitus run` on a person's own recording, good and bad.

mod support;

use std::fs;
use std::path::Path;
use support::{crepitus, csv, done, names, run, run_line, shared, stderr, summary};

/// A scene that plays `file`.
fn scene(file: &str, duration_s: f64, columns: (&str, &str)) -> String {
    format!(
        "version = 1\ntitle = \"A recording\"\nduration_s = {duration_s}\n[motion]\nkind = \"recording\"\n\
         file = '{file}'\ntime_column = \"{}\"\nangle_column = \"{}\"\nunit = \"deg\"\n[solver]\n\
         kind = \"exact-events\"\nstep_s = 5e-5\n[effects.crepitus]\npreset = \"coarse\"\n",
        columns.0, columns.1
    )
}

/// Runs a recording from a folder beside the repository; returns the summary.
fn play(file: &Path, duration_s: f64, columns: (&str, &str), extra: &[&str]) -> serde_json::Value {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("scene.toml");
    fs::write(&path, scene(file.to_str().unwrap(), duration_s, columns)).unwrap();
    let out = home.path().join("out");
    let output = crepitus()
        .args([
            "run",
            path.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ])
        .args(extra)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(names(&out).len(), 4);
    summary(&out)
}

#[test]
fn recorded_squats_grate() {
    let Some(file) = shared("data/opencap_squat_100hz.csv") else {
        return;
    };
    let columns = ("time_s", "knee_flexion_deg");
    let summary = play(&file, 8.0, columns, &[]);
    assert!(
        summary["events"]["break"].as_u64().unwrap() > 150,
        "{summary}"
    );
    assert_eq!(
        summary["warnings"].as_array().unwrap().len(),
        0,
        "{summary}"
    );
    let fastest = summary["fastest_rad_s"].as_f64().unwrap().to_degrees();
    assert!((190.0..230.0).contains(&fastest), "{fastest}");
    // `physical` is affected by the sampling, and warns.
    let summary = play(
        &file,
        8.0,
        columns,
        &["--set", "effects.crepitus.convention=physical"],
    );
    assert!(
        summary["warnings"][0]
            .as_str()
            .unwrap()
            .contains("feels the sampling"),
        "{summary}"
    );
}

#[test]
fn opensim_files_are_read_as_they_are() {
    for (file, duration_s, warns) in [
        ("opensim_walk.mot", 2.37, false),
        ("opencap_walk.mot", 1.57, false),
        ("opensim_crouch_gait.mot", 1.0, true),
    ] {
        let Some(path) = shared("data/raw").map(|raw| raw.join(file)) else {
            return;
        };
        let summary = play(&path, duration_s, ("time", "knee_angle_r"), &[]);
        assert!(
            summary["events"]["break"].as_u64().unwrap() > 5,
            "{summary}"
        );
        let warnings = summary["warnings"].as_array().unwrap();
        assert_eq!(!warnings.is_empty(), warns, "{file}: {warnings:?}");
        if warns {
            let text = warnings[0].as_str().unwrap();
            assert!(text.contains("120") && text.contains("119"), "{text}");
        }
    }
}

/// A good recording: half a second at 100 Hz.
fn good() -> String {
    let rows: Vec<_> = (0..=50)
        .map(|i| {
            let t = f64::from(i) * 0.01;
            format!("{t:.2},{:.3}", 30.0 - 20.0 * (6.0 * t).cos())
        })
        .collect();
    format!("time_s,knee_deg\n{}\n", rows.join("\n"))
}

#[test]
fn a_bad_recording_is_named_and_nothing_is_written() {
    let text = good();
    let with_line_9 = |line: &str| {
        let mut lines: Vec<_> = text.lines().collect();
        lines[8] = line;
        lines.join("\n") + "\n"
    };
    let cases = [
        (text.replace("knee_deg", "hip_deg"), "hip_deg"),
        (with_line_9("0.07,flexed"), "line 9"),
        (with_line_9("0.07,NaN"), "line 9"),
        (with_line_9("0.07,inf"), "line 9"),
        (with_line_9("0.07,"), "line 9"),
        (with_line_9("0.05,30.0"), "line 9"),
        (with_line_9("0.06,30.0"), "line 9"),
        (with_line_9("0.07"), "line 9"),
        ("time_s,knee_deg\n0.0,1.0\n".to_owned(), "at least 4"),
        ("time_s,knee_deg\n".to_owned(), "no rows"),
        (String::new(), "empty"),
        (text[..text.len() - 8].to_owned(), "line 52"),
    ];
    for (content, part) in cases {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join("knee.csv"), &content).unwrap();
        let path = home.path().join("scene.toml");
        fs::write(&path, scene("knee.csv", 0.4, ("time_s", "knee_deg"))).unwrap();
        let out = home.path().join("out");
        let output = run_line(&format!("run {} --out {}", path.display(), out.display()));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}\n{content}");
        assert!(message.contains(part), "{message:?} does not say {part:?}");
        assert!(
            message.contains("knee.csv") && message.contains("scene.toml"),
            "{message}"
        );
        assert_eq!(names(home.path()), ["knee.csv", "scene.toml"]);
    }
}

#[test]
fn a_scene_longer_than_its_recording_is_refused() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("knee.csv"), good()).unwrap();
    let path = home.path().join("scene.toml");
    fs::write(&path, scene("knee.csv", 0.6, ("time_s", "knee_deg"))).unwrap();
    let output = run(&["run", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("longer than its recording"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_repeated_gait_cycle_runs_again_bit_for_bit() {
    let Some(file) = shared("data/raw/opensim_crouch_gait.mot") else {
        return;
    };
    let home = tempfile::tempdir().unwrap();
    let text = scene(file.to_str().unwrap(), 5.5, ("time", "knee_angle_r"));
    let text = text.replace("unit = ", "sign = -1\nrepeat = true\nunit = ");
    let path = home.path().join("scene.toml");
    fs::write(&path, text).unwrap();
    let [first, second] = ["first", "second"].map(|name| home.path().join(name));
    let play = |scene: &Path, out: &Path| {
        done(&format!("run {} --out {}", scene.display(), out.display()));
    };
    play(&path, &first);
    play(&first.join("summary.json"), &second);
    for name in ["trace.csv", "events.csv"] {
        let [a, b] = [&first, &second].map(|folder| fs::read(folder.join(name)).unwrap());
        assert!(a == b, "{name} differs");
    }
    // Flexion is negative in the file, and positive here.
    let (header, rows) = csv(&first.join("trace.csv"));
    assert_eq!(header[1], "angle_rad");
    let angle = |row: usize| rows[row][1].parse::<f64>().unwrap();
    let (start, end) = (angle(0), angle(rows.len() - 1));
    assert!(start > 0.9 && end > 0.9, "{start} {end}");
    // Rows are 50 µs apart, cycles 1 s.
    let off = (0..20_000).map(|i| (angle(i) - angle(i + 80_000)).abs());
    assert!(off.fold(0.0, f64::max) < 1e-9);
}

//! `crepitus run`, `scenes`, `presets`, `completions` as a person or a script
//! uses them.

mod support;

use std::fs;
use support::{crepitus, csv, names, number, run, stderr, stdout, summary};

const FILES: [&str; 4] = ["events.csv", "report.html", "summary.json", "trace.csv"];

#[test]
fn a_scene_becomes_four_files() {
    let home = tempfile::tempdir().unwrap();
    let output = crepitus()
        .args(["run", "fig6-ideal-cycle"])
        .current_dir(home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let folder = home.path().join("out/fig6-ideal-cycle");
    assert_eq!(names(&folder), FILES);
    assert_eq!(names(&home.path().join("out")), ["fig6-ideal-cycle"]);
    let report = "out/fig6-ideal-cycle/report.html";
    assert!(stdout(&output).replace('\\', "/").contains(report));

    let (header, rows) = csv(&folder.join("trace.csv"));
    assert_eq!(
        header.join(","),
        "t_s,angle_rad,omega_rad_s,phase,theta_rad,theta_dot_rad_s,torque_nm"
    );
    assert_eq!(rows.len(), 4_001);
    assert_eq!(
        (rows[600][0].as_str(), rows[4_000][0].as_str()),
        ("0.3", "2.0")
    );
    for row in &rows {
        assert!(["stick", "slip+", "slip-"].contains(&row[3].as_str()));
        assert!(number(&row[6]) <= 0.4 && number(&row[6]) >= 0.0);
    }

    let (header, events) = csv(&folder.join("events.csv"));
    assert_eq!(
        header.join(","),
        "t_s,effect,event,angle_rad,theta_rad,omega_rad_s,torque_before_nm,torque_after_nm"
    );
    assert_eq!(events.len(), 127);
    assert_eq!(
        (number(&events[0][0]), &events[0][1..3]),
        (1e-3, &["crepitus".to_owned(), "break".to_owned()][..])
    );

    let summary = summary(&folder);
    assert_eq!(summary["events"]["break"], 64);
    assert_eq!(summary["effects"][0]["name"], "crepitus");
    // Nothing is timed that nobody asked for: absent, not zero.
    for key in ["ns_per_step", "ns_resolution"] {
        assert!(summary["effects"][0].get(key).is_none(), "{key}");
    }
    assert_eq!(summary["convention"], "frozen");

    let report = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(report.len() < 5_000_000);
    assert!(!report.contains("http://") && !report.contains("https://"));
    assert!(!report.contains("<script"));
    assert!(report.matches("<svg").count() >= 5);
}

#[test]
fn effects_are_timed_when_that_is_asked_for() {
    let home = tempfile::tempdir().unwrap();
    for (name, more) in [("trace", None), ("alone", Some("--no-trace"))] {
        let out = home.path().join(name);
        let out = out.to_str().unwrap();
        let short = [
            "run",
            "encoder",
            "--set",
            "duration_s=0.2",
            "--costs",
            "--out",
            out,
        ];
        let arguments: Vec<_> = short.into_iter().chain(more).collect();
        let output = run(&arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        let summary = summary(&home.path().join(name));
        for effect in summary["effects"].as_array().unwrap() {
            assert!(effect["ns_resolution"].as_f64().unwrap() > 0.0, "{effect}");
            assert!(effect.get("ns_per_step").is_some(), "{effect}");
        }
    }
    let report = fs::read_to_string(home.path().join("trace/report.html")).unwrap();
    assert!(report.contains("ns per step"));
}

#[test]
fn trace_rows_can_be_thinned_and_stay_the_same_rows() {
    let home = tempfile::tempdir().unwrap();
    let rows = |every: &str| {
        let out = home.path().join(every);
        let output = run(&[
            "run",
            "encoder",
            "--set",
            "duration_s=0.2",
            "--set",
            "output.trace_step_s=5e-5",
            "--trace-every",
            every,
            "--out",
            out.to_str().unwrap(),
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        csv(&out.join("trace.csv")).1
    };
    let (all, some) = (rows("1"), rows("7"));
    assert_eq!(all.len(), 4001);
    assert_eq!(some, all.into_iter().step_by(7).collect::<Vec<_>>());
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let home = tempfile::tempdir().unwrap();
    for solver in ["exact", "exact-events"] {
        let files = |name: &str| {
            let out = home.path().join(format!("{solver}-{name}"));
            let output = run(&[
                "run",
                "encoder",
                "--solver",
                solver,
                "--set",
                "duration_s=1",
                "--out",
                out.to_str().unwrap(),
            ]);
            assert!(output.status.success());
            ["trace.csv", "events.csv"].map(|f| fs::read(out.join(f)).unwrap())
        };
        assert_eq!(files("a"), files("b"));
    }
}

#[test]
fn options_change_the_scene() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("run");
    let output = run(&[
        "--json",
        "run",
        "high-speed",
        "--solver",
        "exact",
        "--step",
        "1e-3",
        "--precision",
        "f32",
        "--set",
        "effects.crepitus.preset=fine",
        "--set",
        "duration_s=0.5",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(printed["summary"], summary(&out));
    assert_eq!(printed["out"], out.to_str().unwrap());
    let summary = &printed["summary"];
    assert_eq!(summary["solver"], "exact");
    assert_eq!(summary["step_s"], 1e-3);
    assert_eq!(summary["precision"], "f32");
    assert_eq!(summary["preset"], "fine");
    assert_eq!(summary["simulated_s"], 0.5);
    // The scene's rows are closer than this step.
    assert_eq!(csv(&out.join("trace.csv")).1.len(), 501);
    let warnings = summary["warnings"].to_string();
    assert!(
        warnings.contains("step longer than a stick phase"),
        "{warnings}"
    );
}

#[test]
fn a_solver_that_diverges_is_exit_code_1_and_writes_nothing() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("out");
    let output = run(&[
        "run",
        "knee-pass-physical",
        "--solver",
        "euler",
        "--step",
        "5e-5",
        "--set",
        "effects.crepitus.inertia_kg_m2=1e-5",
        "--set",
        "effects.crepitus.stiffness_nm_per_rad=4e4",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(
        said.contains("\"euler\" diverged") && said.contains("ωn·h = 3.162"),
        "{said}"
    );
    assert!(!out.exists());
}

#[test]
fn bad_input_is_exit_code_2_and_writes_nothing() {
    let home = tempfile::tempdir().unwrap();
    let bad = home.path().join("bad.toml");
    fs::write(&bad, "version = 1\ntitle = \"x\"\nduration_s = 1\n").unwrap();
    let latin = home.path().join("latin.toml");
    fs::write(&latin, b"title = \"45\xb0\"\n").unwrap();
    let before = names(home.path());
    let cases: [(&[&str], &str); 9] = [
        (&["run", "nothing.toml"], "no such file"),
        (&["run", "bad.toml"], "[motion]"),
        (&["run", "latin.toml"], "UTF-8"),
        (&["run", "."], "cannot be read"),
        (
            &["run", "low-speed", "--solver", "exat"],
            "did you mean exact",
        ),
        (&["run", "low-speed", "--step", "-1"], "above 0"),
        (
            &["run", "low-speed", "--set", "duration_s=forever"],
            "a number",
        ),
        (
            &["run", "low-speed", "--set", "effects.crepitus.stiffness=3"],
            "stiffness_nm_per_rad",
        ),
        (
            &["run", "encoder", "--solver", "reference"],
            "[effects.encoder]",
        ),
    ];
    for (arguments, part) in cases {
        let output = crepitus()
            .args(arguments)
            .current_dir(home.path())
            .output()
            .unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(
            message.starts_with("error: ") && message.contains(part),
            "{arguments:?}: {message}"
        );
        let json = crepitus()
            .arg("--json")
            .args(arguments)
            .current_dir(home.path())
            .output()
            .unwrap();
        let printed: serde_json::Value = serde_json::from_str(&stdout(&json)).unwrap();
        assert_eq!(printed["error"]["exit_code"], 2);
    }
    assert_eq!(names(home.path()), before);
}

#[test]
fn bad_usage_is_exit_code_2() {
    for arguments in [
        &["fly"][..],
        &["run"],
        &["run", "low-speed", "--set", "x"],
        &["run", "low-speed", "--trace-every", "0"],
    ] {
        assert_eq!(run(arguments).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn every_shipped_scene_is_listed_and_printed() {
    let listed = stdout(&run(&["scenes"]));
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&run(&["scenes", "--json"]))).unwrap();
    let scenes = json.as_array().unwrap();
    assert!(scenes.len() >= 12);
    for scene in scenes {
        let name = scene["name"].as_str().unwrap();
        assert!(listed.contains(name));
        let file = support::repository().join(scene["file"].as_str().unwrap());
        assert_eq!(
            stdout(&run(&["scenes", name])),
            fs::read_to_string(file).unwrap()
        );
        assert!(
            scene["description"].as_str().unwrap().len() > 60,
            "{name} explains little"
        );
    }
    assert_eq!(run(&["scenes", "nothing"]).status.code(), Some(2));
}

#[test]
fn what_scenes_promise_comes_true() {
    let home = tempfile::tempdir().unwrap();
    let breaks = |name: &str| {
        let out = home.path().join(name);
        let output = run(&["run", name, "--out", out.to_str().unwrap()]);
        assert!(output.status.success(), "{}", stderr(&output));
        let summary = summary(&out);
        assert_eq!(
            summary["warnings"].as_array().unwrap().len(),
            0,
            "{summary}"
        );
        summary["events"]["break"].as_u64().unwrap()
    };
    assert_eq!(breaks("knee-pass-frozen"), 124);
    assert_eq!(breaks("knee-pass-physical"), 3);
    assert_eq!(breaks("presliding"), 0);
    assert_eq!(breaks("reversal-inside-stick"), 24);
    assert!(breaks("restart-from-kinetic") > breaks("restart-elastic"));
}

#[test]
fn presets_name_every_parameter() {
    let text = stdout(&run(&["presets"]));
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&run(&["presets", "--json"]))).unwrap();
    let presets = json.as_array().unwrap();
    let of = |name: &str| presets.iter().find(|p| p["name"] == name).unwrap();
    assert_eq!(of("coarse")["effects"]["crepitus"]["static_torque_nm"], 0.4);
    assert_eq!(
        of("mas-2-reflex")["effects"]["spasticity"]["form"],
        "reflex"
    );
    for preset in presets {
        assert!(text.contains(preset["name"].as_str().unwrap()));
        for (effect, values) in preset["effects"].as_object().unwrap() {
            // All numbers, not only those that the preset gives.
            assert!(values.as_object().unwrap().len() >= 4, "{effect}");
        }
    }
}

#[test]
fn completions_know_the_verbs() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = run(&["completions", shell]);
        assert!(output.status.success());
        assert!(stdout(&output).contains("presets"), "{shell}");
    }
}

#[test]
fn pictures_are_svg_or_pdf() {
    let home = tempfile::tempdir().unwrap();
    let pictures = |format: &str| {
        let out = home.path().join(format);
        let output = crepitus()
            .args([
                "run",
                "fig6-ideal-cycle",
                "--set",
                "duration_s=0.2",
                format,
                "--out",
            ])
            .arg(&out)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        out
    };
    let of = |folder: &std::path::Path, kind: &str| -> Vec<String> {
        let names = names(folder).into_iter();
        names
            .filter_map(|name| Some(name.strip_suffix(kind)?.to_owned()))
            .collect()
    };
    let (svg, pdf) = (pictures("--pictures"), pictures("--pictures=pdf"));
    assert_eq!(of(&svg, ".svg"), of(&pdf, ".pdf"));
    assert!(of(&pdf, ".svg").is_empty() && of(&svg, ".svg").len() > 3);
    for name in of(&pdf, ".pdf") {
        let drawn = fs::read_to_string(svg.join(format!("{name}.svg"))).unwrap();
        let size = drawn
            .split_once("viewBox=\"0 0 ")
            .unwrap()
            .1
            .split_once('"')
            .unwrap()
            .0;
        let points: Vec<f64> = size.split(' ').map(|px| number(px) * 0.75).collect();
        let file = fs::read(pdf.join(format!("{name}.pdf"))).unwrap();
        assert!(
            file.starts_with(b"%PDF-") && file.len() > 5000,
            "{name}: {} bytes",
            file.len()
        );
        let text = String::from_utf8_lossy(&file);
        let page = format!("/MediaBox [0 0 {} {}]", points[0], points[1]);
        assert_eq!(text.matches(&page).count(), 1, "{name}: {page}");
        assert_eq!(text.matches("/Type /Page\n").count(), 1, "{name}");
    }
    let refused = run(&["run", "fig6-ideal-cycle", "--pictures=bmp"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("expected svg or pdf"),
        "{}",
        stderr(&refused)
    );
}

/// Reported before the run, and as bad input.
#[test]
fn places_where_nothing_can_be_are_bad_input() {
    let home = tempfile::tempdir().unwrap();
    let at = |name: &str| home.path().join(name).to_str().unwrap().to_owned();
    let folder = at("folder.wav");
    fs::create_dir(&folder).unwrap();
    let (long, missing, out) = (at(&"x".repeat(300)), at("no/such.wav"), at("out"));
    for arguments in [
        &["--out", &long][..],
        &["--out", "/dev/null/x"],
        &["--out", &out, "--wav", &missing],
        &["--out", &out, "--wav", &folder],
    ] {
        // A run that took its time would not be ended by an error of its place.
        let mut all = vec!["run", "fig6-ideal-cycle", "--set", "duration_s=1e5"];
        all.extend(arguments);
        let output = run(&all);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(!text.contains(".crepitus-"), "{text}");
    }
    assert_eq!(names(home.path()), ["folder.wav"]);
}

#[test]
fn no_run_goes_beside_its_folder() {
    let home = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(support::repository().join("scenes/low-speed.toml")).unwrap();
    fs::write(home.path().join("...toml"), text).unwrap();
    let output = support::crepitus()
        .args(["run", "...toml"])
        .current_dir(home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("name one with --out"));
    assert_eq!(names(home.path()), ["...toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_without_an_end_is_no_scene() {
    support::refuses(
        &["run", "/dev/zero"],
        2,
        "it is a device, expected a regular file",
    );
}

#[test]
fn a_broken_summary_is_named_itself() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("summary.json");
    let file = file.to_str().unwrap();
    fs::write(
        file,
        r#"{"scene": "scenes/low-speed.toml", "scene_as_run": "version = 1"}"#,
    )
    .unwrap();
    support::refuses(
        &["run", file],
        2,
        &format!("{file}: `duration_s`: in `scene_as_run`"),
    );
}

/// A seat on a leg without mass has no frequency to warn of.
#[test]
fn a_shell_needs_a_limb() {
    let shell = [
        "--set",
        "effects.shell.mass_kg=0.25",
        "--set",
        "duration_s=1",
    ];
    let mut arguments = vec!["run", "slow-examination"];
    arguments.extend(shell);
    support::refuses(&arguments, 2, "needs [effects.limb]");
}

#[test]
fn as_many_draws_as_nobody_waits_for_are_refused() {
    support::refuses(&["vibration", "--draws", "99999999999"], 2, "0..=1000000");
}

/// The speeds of the study replaced what was set, silently.
#[test]
fn a_study_of_vibration_takes_speeds_from_one_place() {
    for set in [
        "motion.velocity_rad_s=0.3",
        "motion.from_deg=40",
        "duration_s=1",
    ] {
        support::refuses(&["vibration", "--set", set], 2, "use --speeds");
    }
    let strokes = ["vibration", "passive-examination", "--speeds", "0.5"];
    support::refuses(&strokes, 2, "leave --speeds out");
}

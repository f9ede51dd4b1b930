//! `crepitus effects` as a person or a script uses it.

mod support;

use crepitus_plant::effects::EFFECTS;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::{crepitus, csv, names, run, stderr, stdout, summary};

fn effects(arguments: &[&str]) -> Output {
    run(&[&["effects"], arguments].concat())
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&stdout(output)).expect("JSON")
}

/// A third of a second of a hand-like sine with these effects.
fn scene(folder: &Path, name: &str, effects: &[&str]) -> PathBuf {
    let mut text = "version = 1\ntitle = \"A short sine\"\nduration_s = 0.3\n\
                    [motion]\nkind = \"sine\"\namplitude_deg = 20\nfrequency_hz = 1.3\n\
                    [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n"
        .to_owned();
    for effect in effects {
        text.extend(["[effects.", effect, "]\n"]);
    }
    let file = folder.join(format!("{name}.toml"));
    fs::write(&file, text).unwrap();
    file
}

const FILES: [&str; 3] = ["effects.csv", "report.html", "summary.json"];

#[test]
fn a_study_becomes_three_files() {
    let home = tempfile::tempdir().unwrap();
    let has = ["crepitus", "drivetrain", "friction-compensation", "limb"];
    let file = scene(home.path(), "knee", &has);
    let out = home.path().join("study");
    let files = [file.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let output = effects(&[&files[..], &["--all"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(names(&out), FILES);
    let text = stdout(&output);
    let count = EFFECTS.len();
    for part in [
        &format!("4 of {count} effects run: "),
        &format!(
            "The other {} are not built: no state, no instruction.",
            count - 4
        ),
        "Between 10 and 450 Hz the hand feels ",
        "Without friction-compensation that is ",
        "A short sine: 6000 ticks of 50 µs",
        "without drivetrain (and friction-compensation)",
        "with backlash",
        "report.html",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let first = stdout(&effects(&[&files[..], &["--force"]].concat()));
    assert!(
        first.starts_with(&format!("4 of {count} effects run: ")) && first.lines().count() <= 25,
        "{first}"
    );
    let place = |what: &str| {
        first
            .rfind(what)
            .unwrap_or_else(|| panic!("{what}: {first}"))
    };
    assert!(
        place("without friction-compensation") < place("without crepitus"),
        "by what vibrates: {first}"
    );

    let (header, rows) = csv(&out.join("effects.csv"));
    assert_eq!(
        header.join(","),
        "change,effect,along,states,added_states,ns_per_step,time_spread,added_ns_per_step,\
         added_ns_resolution,instructions_per_step,added_instructions_per_step,added_rms_nm,added_peak_nm,rms_nm,peak_nm,rms_10_50_hz_nm,rms_50_250_hz_nm,rms_250_450_hz_nm,events,\
         added_events,failure"
    );
    assert_eq!(rows.len(), 1 + EFFECTS.len());
    let summary = summary(&out);
    assert_eq!(summary["ticks"], 6000);
    assert_eq!(summary["rows"].as_array().unwrap().len(), rows.len());
    assert_eq!(summary["rows"][1]["change"], "without");
    assert!(summary["rows"][1]["added_rms_nm"].as_f64().unwrap() > 0.0);
    assert!(summary["answer"].is_null());
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.len() < 5_000_000);
    assert!(!report.contains("http://") && !report.contains("https://"));
}

#[test]
fn the_book_has_the_build_up_of_both_figures() {
    let home = tempfile::tempdir().unwrap();
    let book = fs::read_to_string(support::repository().join("docs/effects.md")).unwrap();
    for scene in ["fig8", "fig9"] {
        let out = home.path().join(scene);
        let text = stdout(&effects(&[scene, "--all", "--out", out.to_str().unwrap()]));
        let table: Vec<&str> = text
            .lines()
            .skip_while(|line| !line.contains("ripple, mN·m pp"))
            .collect();
        let rows = table.iter().take_while(|line| !line.is_empty());
        assert_eq!(rows.clone().count(), 8, "{scene}: {text}");
        for row in rows {
            assert!(
                book.contains(row),
                "{scene}: docs/effects.md has another line than\n{row}"
            );
        }
    }
}

#[test]
fn a_tolerance_names_the_smallest_set() {
    let home = tempfile::tempdir().unwrap();
    let has = ["crepitus", "encoder", "drivetrain", "limb"];
    let file = scene(home.path(), "knee", &has);
    let out = home.path().join("study");
    let arguments = [
        file.to_str().unwrap(),
        "--tolerance",
        "torque=0.25",
        "--out",
        out.to_str().unwrap(),
    ];
    let output = effects(&[&["--json"], &arguments[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = json(&output);
    assert_eq!(printed["out"], out.to_str().unwrap());
    let answer = &printed["summary"]["answer"];
    let chosen: Vec<&str> = answer["chosen"]["effects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| e.as_str().unwrap())
        .collect();
    // Without the leg's weight or the gear's friction it is not the same;
    // encoder and grating are smaller than that.
    assert!(chosen.contains(&"limb") && chosen.contains(&"drivetrain"));
    assert!(chosen.len() < has.len(), "{chosen:?}");
    assert_eq!(
        answer["kept"].as_array().unwrap().len() + answer["dropped"].as_array().unwrap().len(),
        has.len()
    );

    let output = effects(&arguments);
    let text = stdout(&output);
    assert!(text.lines().count() <= 25, "{text}");
    assert!(
        text.contains("The smallest set that stays within it: "),
        "{text}"
    );
    assert!(text.contains("Dropped; each alone makes:"), "{text}");
    assert!(text.contains("Kept; dropping it too would make:"), "{text}");
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("The smallest set within the tolerance"));
}

#[test]
fn the_default_folder_is_named_after_the_scene_and_pictures_come_if_asked_for() {
    let home = tempfile::tempdir().unwrap();
    let output = crepitus()
        .args(["effects", "reversal-inside-stick", "--pictures"])
        .args(["--set", "duration_s=0.5"])
        .current_dir(home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let folder = home.path().join("out/reversal-inside-stick-effects");
    assert_eq!(
        names(&folder),
        [
            "bands.svg",
            "effects.csv",
            "hand-torque.svg",
            "influence-and-cost.svg",
            "report.html",
            "summary.json"
        ]
    );
}

#[test]
fn pictures_need_a_scene() {
    let output = effects(&["--pictures"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("needs a SCENE"));
}

#[test]
fn without_a_scene_the_table_of_effects_is_printed() {
    let short = stdout(&effects(&[]));
    assert!(short.lines().count() <= 25, "{short}");
    assert!(
        EFFECTS
            .iter()
            .all(|effect| short.contains(effect.name) && short.contains(effect.adds))
    );
    let output = effects(&["--all"]);
    assert_eq!(output.status.code(), Some(0));
    let text = stdout(&output);
    let list = json(&effects(&["--json"]));
    let list = list.as_array().unwrap();
    assert_eq!(list.len(), EFFECTS.len());
    for (effect, printed) in EFFECTS.iter().zip(list) {
        assert_eq!(printed["name"], effect.name);
        assert!(text.contains(&format!("{}: {}", effect.name, effect.adds)));
        assert_eq!(
            printed["states"].as_array().unwrap().len(),
            effect.states.len()
        );
        for (parameter, printed) in effect
            .parameters
            .iter()
            .zip(printed["parameters"].as_array().unwrap())
        {
            assert_eq!(printed["key"], parameter.key);
            assert_eq!(printed["default"], parameter.default);
            assert_eq!(
                (&printed["min"], &printed["max"]),
                (&parameter.min.into(), &parameter.max.into())
            );
            assert!(text.contains(parameter.key) && text.contains(parameter.meaning));
        }
        for need in effect.needs {
            assert!(text.contains(&format!("needs {}: {}", need.effect, need.why)));
        }
        for choice in effect.choices {
            assert!(text.contains(choice.key) && text.contains(choice.names[0]));
        }
    }
}

#[test]
fn what_cannot_be_studied_is_refused_with_the_key() {
    let home = tempfile::tempdir().unwrap();
    let joint = scene(home.path(), "joint", &["crepitus"]);
    let joint = joint.to_str().unwrap();
    let released = home.path().join("falls.toml");
    fs::write(
        &released,
        "version = 1\ntitle = \"falls\"\nduration_s = 0.1\n[motion]\nkind = \"released\"\nfrom_deg = 10\n\
         [solver]\nkind = \"exact\"\nstep_s = 5e-5\n[effects.limb]\n",
    )
    .unwrap();
    let released = released.to_str().unwrap();
    let out = home.path().join("nothing");
    let wrong = scene(home.path(), "wrong", &["gravity"]);
    let wrong = wrong.to_str().unwrap();
    for (arguments, parts) in [
        (vec![released], ["falls.toml", "`motion.kind`"]),
        (
            vec![joint, "--set", "duration_s=1e4"],
            ["`duration_s`", "40000000"],
        ),
        (vec![wrong], ["wrong.toml, line 11", "gravity"]),
        (vec!["no-such-scene"], ["no-such-scene", "ships"]),
        (
            vec![joint, "--tolerance", "speed=1"],
            ["--tolerance", "torque=5e-3,events=0.01"],
        ),
        (vec![joint, "--tolerance", "torque=0"], ["above 0", "N·m"]),
        (
            vec![joint, "--set", "solver.kind=\"cubic\""],
            ["solver.kind", "exact-events"],
        ),
    ] {
        let more = ["--out", out.to_str().unwrap()];
        let output = effects(&[&arguments[..], &more[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        for part in parts {
            let said = stderr(&output);
            assert!(said.contains(part), "{arguments:?}: {said}");
        }
        assert_eq!(stdout(&output), "", "{arguments:?}");
        assert!(!out.exists());
    }
    let output = effects(&["--tolerance", "torque=1"]);
    assert_eq!(output.status.code(), Some(2));

    let text = fs::read_to_string(joint).unwrap();
    let text = text.replace(
        "kind = \"exact-events\"\nstep_s = 5e-5",
        "kind = \"reference\"",
    );
    fs::write(joint, text).unwrap();
    let output = effects(&[joint]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("`solver.kind`"));
}

#[test]
fn a_scene_that_diverges_fails_and_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let file = scene(home.path(), "wild", &["crepitus"]);
    let out = home.path().join("nothing");
    let output = effects(&[
        file.to_str().unwrap(),
        "--set",
        "effects.crepitus.convention=\"physical\"",
        "--set",
        "solver.kind=\"euler\"",
        "--set",
        "solver.step_s=2e-2",
        "--set",
        "duration_s=20",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", stdout(&output));
    assert!(stderr(&output).contains("diverged"), "{}", stderr(&output));
    assert_eq!(names(home.path()), ["wild.toml"]);
}

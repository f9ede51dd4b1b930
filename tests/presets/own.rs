//! Presets of one's own: saved, listed, applied, compared.

use crate::Knee;
use crate::support::{crepitus, names, stderr, stdout};
use crepitus_scene::preset::shipped;
use serde_json::{Value, json};
use std::fs;

#[test]
fn a_knee_is_saved_and_comes_back_to_the_bit() {
    let knee = Knee::new();
    knee.done(&["params", "apply", "capsular"]);
    knee.done(&[
        "params",
        "set",
        "crepitus.render=on",
        "crepitus.restart=from-kinetic",
        "crepitus.inertia_kg_m2=0.012345678901234567",
        "range-limit.flexion_limit_deg=98.76543210987654",
        "friction-compensation.render=on",
    ]);
    let before = knee.values();
    let save = [
        "params",
        "save-preset",
        "monday-knee",
        "--title",
        "The \"knee\" of Monday",
        "--disorder",
        "range-deficit",
        "--level",
        "moderate",
    ];
    let saved = knee.json(&save);
    assert_eq!(saved["effects"], json!(["crepitus", "range-limit"]));
    let file = knee.presets().join("monday-knee.toml");
    assert_eq!(saved["file"], json!(file));
    let first = fs::read_to_string(&file).unwrap();
    assert!(
        first.contains("flexion_limit_deg = 98.76543210987654\n"),
        "{first}"
    );
    assert_eq!(
        knee.json(&["presets", "monday-knee"])["level"],
        json!("moderate")
    );

    knee.done(&["params", "reset"]);
    let diff = knee.json(&["params", "diff"]);
    let left: Vec<_> = diff["differences"]
        .as_array()
        .unwrap()
        .iter()
        .map(|d| &d["name"])
        .collect();
    assert_eq!(left, ["friction-compensation.render"]);
    let diff = knee.json(&["params", "diff", "monday-knee"]);
    let limit = diff["differences"].as_array().unwrap().iter();
    let limit = limit
        .clone()
        .find(|d| d["name"] == "range-limit.flexion_limit_deg");
    let limit = limit.unwrap();
    assert_eq!(
        (&limit["device"], &limit["other"]),
        (&json!(120.0), &json!(98.765_432_109_876_54))
    );
    knee.done(&["params", "apply", "monday-knee"]);
    assert_eq!(knee.values(), before);
    let same = knee.done(&["params", "diff", "monday-knee"]);
    assert!(same.contains("does not differ from monday-knee"), "{same}");
    let text = knee.done(&["params", "diff"]);
    assert!(
        text.contains("from-kinetic") && text.contains("98.76543210987654"),
        "{text}"
    );

    // By name, the brace's groups, too.
    knee.done(&["params", "reset", "friction-compensation", "crepitus"]);
    let values = knee.values();
    assert_eq!(values["friction-compensation.render"], "off");
    assert_eq!(values["crepitus.restart"], "elastic");
    assert_eq!(values["range-limit.render"], "on");

    // Nothing is replaced without being asked for, and nothing is left behind.
    knee.refused(&save, &["monday-knee.toml already exists", "--force"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), first);
    knee.done(&["params", "save-preset", "monday-knee", "--force"]);
    assert_ne!(fs::read_to_string(&file).unwrap(), first);
    assert_eq!(names(&knee.presets()), ["monday-knee.toml"]);
}

#[test]
fn own_presets_stand_beside_those_that_ship() {
    let knee = Knee::new();
    assert!(!knee.done(&["presets"]).contains("Your own"));
    knee.done(&["params", "save-preset", "mine", "--feel", "a first try"]);
    fs::write(
        knee.presets().join("broken.toml"),
        "[effects.clonus]\nbeats = -1\n",
    )
    .unwrap();
    fs::write(knee.presets().join("notes.txt"), "nothing").unwrap();
    let output = knee.run(&["presets"]);
    let text = stdout(&output);
    assert!(
        text.contains("Your own, in ") && text.contains("a first try"),
        "{text}"
    );
    assert!(
        stderr(&output).contains("broken.toml, line 2: `effects.clonus.beats`"),
        "{}",
        stderr(&output)
    );
    let list = knee.json(&["presets"]);
    let list = list.as_array().unwrap();
    assert_eq!(list.len(), shipped().len() + 1);
    let mine = list.last().unwrap();
    assert_eq!(
        (&mine["name"], &mine["evidence"]),
        (&json!("mine"), &Value::Null)
    );
    assert_eq!(mine["file"], json!(knee.presets().join("mine.toml")));
    assert!(knee.done(&["presets", "mine"]).contains("mine.toml"));
    assert_eq!(knee.json(&["presets", "mine"]), *mine);
    knee.refused(
        &["params", "apply", "broken"],
        &["broken.toml, line 2", "up to 200"],
    );
}

/// Folder of the presets without a variable of its own: the user's configuration.
#[test]
fn the_folder_is_the_users_configuration() {
    let home = tempfile::tempdir().unwrap();
    for (variable, file) in [
        ("XDG_CONFIG_HOME", "crepitus/presets/mine.toml"),
        ("HOME", ".config/crepitus/presets/mine.toml"),
    ] {
        let mut command = crepitus();
        command
            .args(["params", "save-preset", "mine", "--device", "sim"])
            .env_remove("CREPITUS_PRESETS")
            .env_remove("XDG_CONFIG_HOME")
            .env(variable, home.path());
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(home.path().join(file).is_file(), "{file}");
    }
}

#[test]
fn a_file_in_place_of_the_folder_is_named_and_hides_nothing_that_ships() {
    let knee = Knee::new();
    fs::write(knee.presets(), "").unwrap();
    for force in [&[][..], &["--force"]] {
        let save = [&["params", "save-preset", "monday"], force].concat();
        knee.refused(&save, &["presets is no folder", "CREPITUS_PRESETS"]);
    }
    let output = knee.run(&["presets", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("warning: ")
            && stderr(&output).contains("presets: cannot be read"),
        "{}",
        stderr(&output)
    );
    let list: Vec<Value> = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(list.len(), shipped().len());
}

#[test]
fn a_scene_does_not_name_an_own_preset_and_the_list_says_so() {
    let knee = Knee::new();
    knee.done(&["params", "apply", "scats-1-clonus"]);
    knee.done(&["params", "save-preset", "mine"]);
    let list = knee.done(&["presets"]);
    assert!(
        list.contains("takes the values of those that ship"),
        "{list}"
    );
    knee.refused(
        &["run", "clonus-hold", "--set", "effects.clonus.preset=mine"],
        &[
            "\"mine\" is not allowed",
            "your own presets cannot be named",
        ],
    );
}

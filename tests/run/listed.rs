//! Lists that the program prints: scenes, presets, completions of a shell.

use crate::support::{self, run, stdout};
use std::fs;

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

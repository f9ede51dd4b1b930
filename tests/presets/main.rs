//! Presets as a teacher uses them: listed, applied, saved, compared, reset.
#![cfg(target_os = "linux")]

mod judged;
mod naming;
mod own;
#[path = "../support/mod.rs"]
mod support;

use crepitus_scene::preset::{Disorder, Preset, shipped};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::served::Served;
use support::{crepitus, run, stderr, stdout, summary};

/// A served device, and a folder for presets.
struct Knee {
    served: Served,
}

impl Knee {
    fn new() -> Self {
        Self {
            served: Served::new(),
        }
    }

    fn presets(&self) -> PathBuf {
        self.served.home.path().join("presets")
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = self.served.command(arguments);
        command.env("CREPITUS_PRESETS", self.presets());
        command.output().unwrap()
    }

    fn done(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let mut all = arguments.to_vec();
        all.push("--json");
        serde_json::from_str(&self.done(&all)).unwrap()
    }

    /// All parameters.
    fn values(&self) -> Value {
        self.json(&["params", "get"])["values"].take()
    }

    fn refused(&self, arguments: &[&str], parts: &[&str]) {
        let before = self.values();
        let output = self.run(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        for part in parts {
            assert!(
                text.contains(part),
                "{arguments:?}: {part:?} is not in {text}"
            );
        }
        assert_eq!(self.values(), before, "{arguments:?}");
    }
}

#[test]
fn a_preset_is_a_whole_knee_in_one_commit() {
    let knee = Knee::new();
    let revision = |done: &Value| done["revision"].as_u64().unwrap();
    let first = knee.json(&["params", "apply", "mas-2-catch"]);
    assert_eq!(first["on"], json!(["spasticity"]));
    assert_eq!(first["off"], json!(["crepitus"]));
    assert_eq!(first["warnings"], json!([]));
    assert_eq!(first["zeroed"], false);
    let second = knee.run(&["params", "apply", "texture-bone-on-bone"]);
    assert!(
        stderr(&second).contains("5.1 N·m together") && stderr(&second).contains("4.5 N·m at most"),
        "{}",
        stderr(&second)
    );
    let text = stdout(&second);
    for line in [
        "now on: range-limit, texture",
        "now off: spasticity",
        "`crepitus zero`",
    ] {
        assert!(text.contains(line), "{line:?} is not in {text}");
    }
    // The brace is not the knee.
    knee.done(&[
        "params",
        "set",
        "friction-compensation.render=on",
        "range.most_deg=110",
    ]);
    let third = knee.json(&["params", "apply", "updrs-2-cogwheel", "--add"]);
    assert_eq!(
        (&third["on"], &third["off"]),
        (&json!(["cogwheel"]), &json!([]))
    );
    assert_eq!(revision(&third), revision(&first) + 3);
    assert_eq!(third["warnings"].as_array().unwrap().len(), 1);
    let fourth = knee.json(&["params", "apply", "fine"]);
    assert_eq!(fourth["off"], json!(["range-limit", "cogwheel", "texture"]));
    let values = knee.values();
    for (name, expected) in [
        ("crepitus.stiffness_nm_per_rad", json!(320.0)),
        ("texture.peak_nm", json!(0.4)),
        ("friction-compensation.render", json!("on")),
        ("range.most_deg", json!(110.0)),
    ] {
        assert_eq!(values[name], expected, "{name}");
    }
    // A scene says for friction compensation, too, that there is none.
    let scene = knee.json(&["params", "apply", "slow-examination"]);
    assert_eq!(scene["off"], json!(["friction-compensation"]));
    assert_eq!(knee.values()["range.most_deg"], 110.0);
}

/// `--add` keeps only what the preset does not have.
#[test]
fn an_effect_that_was_on_and_gets_other_values_is_named() {
    let knee = Knee::new();
    let add = |preset| knee.done(&["params", "apply", preset, "--add"]);
    knee.done(&["params", "apply", "bone-block"]);
    let text = add("texture-bone-on-bone");
    assert!(
        text.contains("now on: texture\n") && text.contains("changed, on before: range-limit\n"),
        "{text}"
    );
    let same = add("texture-bone-on-bone");
    assert!(!same.contains("changed"), "{same}");
    let back = knee.json(&["params", "apply", "bone-block", "--add"]);
    assert_eq!(
        (&back["on"], &back["off"], &back["changed"]),
        (&json!([]), &json!([]), &json!(["range-limit"]))
    );
    // What goes off is not on after it.
    let reset = knee.json(&["params", "reset"]);
    assert_eq!(
        (&reset["on"], &reset["changed"]),
        (&json!(["crepitus"]), &json!([]))
    );
}

/// Largest torque at the hand in a stretch from 10° to 110° at 10 deg/s, N·m.
fn slow_stretch_nm(preset: &Preset, folder: &Path) -> f64 {
    let name = &preset.name;
    let effect = preset.effects().next().unwrap().name;
    let scene = folder.join(format!("{name}.toml"));
    let text = format!(
        "version = 1\ntitle = \"A slow stretch\"\nduration_s = 10.0\n\n\
         [motion]\nkind = \"constant\"\nfrom_deg = 10.0\nvelocity_rad_s = {}\n\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 1e-3\n\n\
         [effects.{effect}]\npreset = \"{name}\"\n",
        10_f64.to_radians()
    );
    fs::write(&scene, text).unwrap();
    let out = folder.join(name);
    let [scene, to] = [&scene, &out].map(|path| path.to_str().unwrap());
    let output = run(&["run", scene, "--no-trace", "--out", to]);
    assert!(output.status.success(), "{}", stderr(&output));
    summary(&out)["hand_torque"]["max_nm"].as_f64().unwrap()
}

/// Texts in English, and in the panel's German.
#[test]
fn a_preset_of_spasticity_says_what_a_slow_stretch_meets() {
    let home = tempfile::tempdir().unwrap();
    let german = support::repository().join("host/panel/assets/strings/de.json");
    let german: Value = serde_json::from_str(&fs::read_to_string(german).unwrap()).unwrap();
    let words = [
        (
            "nothing when slow",
            ["in a slow stretch", "a little when slow", "any speed"],
        ),
        (
            "langsam nichts",
            ["auch langsam", "langsam ab", "jedem Tempo"],
        ),
    ];
    let is_spastic = |preset: &&Preset| preset.disorder == Some(Disorder::Spasticity);
    let mut quiet = 0;
    for preset in shipped().iter().filter(is_spastic) {
        let name = &preset.name;
        let slow_nm = slow_stretch_nm(preset, home.path());
        let translated = german[format!("preset.{name}.feel")].as_str().unwrap();
        let texts = [preset.feel.as_deref().unwrap(), translated];
        for (text, (nothing, something)) in texts.into_iter().zip(words) {
            let says_nothing = text.contains(nothing);
            let says_something = something.iter().any(|part| text.contains(part));
            assert_eq!(
                says_something,
                slow_nm >= 0.1,
                "{name}, {slow_nm} N·m: {text}"
            );
            assert!(!(says_nothing && says_something), "{name}: {text}");
            quiet += u32::from(says_nothing);
        }
    }
    assert_eq!(quiet, 8);
}

#[test]
fn a_set_that_asks_for_more_than_the_device_shows_warns() {
    let knee = Knee::new();
    let quiet = knee.run(&[
        "params",
        "set",
        "lead-pipe.render=on",
        "lead-pipe.torque_nm=4",
    ]);
    assert_eq!(stderr(&quiet), "");
    let loud = knee.run(&["params", "set", "lead-pipe.torque_nm=4.3"]);
    assert!(loud.status.success());
    assert!(
        stderr(&loud).contains("4.7 N·m together"),
        "{}",
        stderr(&loud)
    );
    let lower = knee.json(&[
        "params",
        "set",
        "limits.torque_nm=4",
        "lead-pipe.torque_nm=3.8",
    ]);
    let warning = lower["warnings"][0].as_str().unwrap();
    assert!(
        warning.contains("4.2 N·m together") && warning.contains("4 N·m at most"),
        "{warning}"
    );
}

#[test]
fn the_list_says_what_to_feel_for_and_how_sure_it_is() {
    let empty = tempfile::tempdir().unwrap();
    let listed = |arguments: &[&str]| {
        let mut command = crepitus();
        command
            .args(arguments)
            .env("CREPITUS_PRESETS", empty.path());
        stdout(&command.output().unwrap())
    };
    let text = listed(&["presets"]);
    for preset in shipped() {
        let start = format!("  {} ", preset.name);
        let lines: Vec<_> = text.lines().filter(|l| l.starts_with(&start)).collect();
        let [line] = lines.as_slice() else {
            panic!("{}: {lines:?}", preset.name)
        };
        assert!(line.ends_with(preset.feel.as_ref().unwrap()), "{line}");
        assert!(line.contains(preset.evidence.unwrap().name()), "{line}");
    }
    for grade in ["MAS 0 is its absence", "UPDRS 0", "SCATS 0"] {
        assert!(text.contains(grade), "{text}");
    }
    assert_eq!(
        listed(&["presets", "mas-2-reflex"]),
        "\
Spasticity, MAS 2, as a stretch reflex makes it
  severity  MAS 2: more marked through most of the range, but the part is easily moved
  level     moderate
  feel for  a push, a moment late, that pushes back at a stop; also in a slow stretch, from 75° on; earlier and stronger when fast
  evidence  estimate
  source    grades: Bohannon and Smith 1987; gain: McCrea et al. 2003, speed: Levin and Feldman 2003 (elbows); \
delays: De Groote et al. 2018; threshold is an estimate

[effects.spasticity]
                   value  unit     evidence  meaning
form              reflex           estimate
threshold_deg         75  deg      estimate  angle at which a slow stretch meets the threshold
velocity_shift_s    0.27  s        sourced   how much earlier the threshold is for each rad/s of stretch
gain_nm_per_rad     2.43  N·m/rad  sourced   torque of the muscle for each radian beyond the threshold; form reflex

All other parameters are at their defaults: `crepitus effects` lists them.
"
    );
    assert_eq!(run(&["presets", "wobble"]).status.code(), Some(2));
    assert!(stderr(&run(&["presets", "mas-0-catch"])).contains("MAS 0"));
}

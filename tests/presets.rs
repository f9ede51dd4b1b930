//! Presets as a teacher uses them: listed, applied, saved, compared, reset.
#![cfg(target_os = "linux")]

mod support;

use crepitus_scene::preset::{Disorder, Preset, shipped};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::served::Served;
use support::{crepitus, names, run, stderr, stdout, summary};

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

#[test]
fn a_file_is_a_preset_a_fragment_or_a_scene() {
    let knee = Knee::new();
    let folder = knee.served.home.path();
    let write = |name: &str, text: &str| {
        let file = folder.join(name);
        fs::write(&file, text).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let fragment = write("fragment.toml", "[effects.clonus]\nbeats = 3\n");
    knee.done(&["params", "apply", &fragment]);
    assert_eq!(knee.values()["clonus.beats"], 3.0);
    let repository = support::repository();
    let preset = repository.join("presets/mas-4-lead-pipe.toml");
    knee.done(&["params", "apply", preset.to_str().unwrap()]);
    assert_eq!(knee.values()["lead-pipe.torque_nm"], 4.5);
    let scene = repository.join("scenes/preset-fine.toml");
    let scene = scene.to_str().unwrap();
    knee.done(&["params", "apply", scene]);
    assert_eq!(knee.values()["crepitus.static_torque_nm"], 0.14);

    let leg = write("leg.toml", "[effects.texture]\n\n[effects.limb]\n");
    let typo = write("typo.toml", "[effects.texture]\npeak = 1\n");
    let broken = write("broken.toml", "[effects.texture\n");
    let forgotten = write(
        "forgotten.toml",
        "title = \"x\"\ndescription = \"x\"\n[motion]\n[solver]\n[effects.texture]\n",
    );
    for (arguments, parts) in [
        (
            &["params", "apply", &leg][..],
            &["leg.toml, line 3", "`effects.limb`", "version = 1"][..],
        ),
        (
            &["params", "apply", &typo],
            &["typo.toml, line 2", "did you mean peak_nm?"],
        ),
        (
            &["params", "apply", &broken],
            &["broken.toml, line 1", "not valid TOML"],
        ),
        (
            &["params", "apply", folder.to_str().unwrap()],
            &["cannot be read"],
        ),
        (
            &["params", "apply", "mas-0"],
            &["MAS 0 is a knee without spasticity"],
        ),
        (&["params", "diff", "updrs-0-cogwheel"], &["UPDRS 0"]),
        (&["params", "apply", "UPDRS-0"], &["UPDRS 0"]),
        (
            &["params", "apply", "MAS-2"],
            &[
                "no such preset",
                "of this kind are mas-2-catch, mas-2-reflex",
            ],
        ),
        (
            &["params", "apply", &forgotten],
            &["forgotten.toml", "needs `version = 1`"],
        ),
        (
            &["params", "apply", "no-such"],
            &["`crepitus presets`", "`crepitus scenes`"],
        ),
        (
            &["params", "apply", scene, "--add"],
            &["--add needs a preset"],
        ),
        (&["params", "reset", "wobble"], &["wobble", "texture"]),
        (&["params", "save-preset", "coarse"], &["ships", "another"]),
        (&["params", "save-preset", "../up"], &["small letters"]),
        (&["params", "save-preset", "CON"], &["small letters"]),
        (&["params", "save-preset", "con"], &["Windows"]),
        (
            &["params", "save-preset", "x", "--disorder", "limp"],
            &["limp", "clasp-knife"],
        ),
        (
            &["params", "save-preset", "x", "--level", "marked"],
            &["marked", "moderate"],
        ),
        (
            &["params", "save-preset", "x", "--feel", "two\nlines"],
            &["`feel`", "one line"],
        ),
    ] {
        knee.refused(arguments, parts);
    }
    knee.done(&["params", "set", "crepitus.render=off"]);
    knee.refused(
        &["params", "save-preset", "nothing"],
        &["every effect of the knee is off"],
    );
    assert!(!knee.presets().exists());
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

#[test]
fn a_folder_of_its_name_does_not_hide_a_scene_that_ships() {
    let knee = Knee::new();
    let folder = knee.served.home.path();
    fs::create_dir(folder.join("slow-examination")).unwrap();
    for arguments in [
        &["params", "apply", "slow-examination"][..],
        &["run", "slow-examination", "--set", "duration_s=0.1"],
    ] {
        let mut command = knee.served.command(arguments);
        let output = command.current_dir(folder).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
    }
}

#[test]
fn a_part_of_a_name_leads_to_the_presets_that_have_it() {
    let output = run(&["presets", "updrs"]);
    assert_eq!(output.status.code(), Some(2));
    let error = stderr(&output);
    assert!(
        error.contains("updrs-1-lead-pipe, updrs-2-lead-pipe"),
        "{error}"
    );
    let error = stderr(&run(&["presets", "MAS-2"]));
    assert!(error.contains("mas-2-catch, mas-2-reflex"), "{error}");
    let error = stderr(&run(&["presets", "nothing-like-it"]));
    assert!(
        !error.contains("of this kind") && !error.contains("did you mean"),
        "{error}"
    );
}

#[test]
fn a_slip_of_the_finger_leads_to_the_name() {
    for (arguments, meant) in [
        (&["presets", "mas-2-katch"][..], "mas-2-catch"),
        (&["params", "apply", "mas-2-katch"], "mas-2-catch"),
        (&["params", "apply", "tardieu-fats"], "tardieu-fast"),
        (&["scenes", "tardieu-fats"], "tardieu-fast"),
        (&["run", "Tardieu-Fast"], "tardieu-fast"),
        (&["run", "scenes/tardieu-fats.toml"], "tardieu-fast"),
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let error = stderr(&output);
        assert!(
            error.contains(&format!(" (did you mean {meant}?)")),
            "{error}"
        );
    }
}

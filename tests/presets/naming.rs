//! Names and files of presets: what is found, and what else was meant.

use crate::Knee;
use crate::support::{self, run, stderr};
use std::fs;

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

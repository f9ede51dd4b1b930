use super::*;
use crate::lesson::plans;
use crate::live::{Aim, Target};
use crepitus_knee::examination::signs;
use crepitus_scene::preset::{Disorder, Level};
use crepitus_studies::experiment::finding::Finding;
use serde_json::json;

/// Targets of the panel that the shipped lessons name.
const TARGETS: [&str; 3] = ["slow", "fast", "ashworth"];

/// Speed that a device allows, °/s.
const FASTEST_DEG_S: f64 = 300.0;

fn known() -> Known<'static> {
    Known {
        own_preset: &|name| {
            let disorder = match name {
                "mine" => Some(Finding::Disorder(Disorder::Clonus)),
                "nameless" => None,
                _ => return None,
            };
            Some(Knee {
                preset: name.to_owned(),
                title: "A knee of mine".to_owned(),
                disorder,
                level: None,
            })
        },
        target: &|name| TARGETS.contains(&name),
    }
}

fn check(text: &str) -> Result<CheckedPlan, PlanError> {
    Plan::from_toml(text)?.check(known())
}

#[test]
fn every_shipped_lesson_is_valid() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../lessons");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    let mut names: Vec<_> = plans::FILES
        .iter()
        .map(|file| format!("{}.toml", file.name))
        .collect();
    names.sort();
    assert_eq!(files, names);
    for file in plans::FILES {
        let plan = file.read().unwrap().check(known()).unwrap();
        assert!(!plan.plan().description.is_empty(), "{}", file.name);
        assert_eq!(plan.plan().knees.len(), plan.knees().len());
        assert!(plan.plan().instruction.is_some(), "{}", file.name);
    }
    let blind = |name: &str| plans::find(name).unwrap().read().unwrap().blind;
    assert!(blind("blind-six") && blind("grades-of-spasticity"));
    assert!(!blind("first-knees") && !blind("end-feels"));
    assert!(plans::find("wobble").is_none());
}

/// A student who keeps to the target of a knee feels all of its signs.
#[test]
fn every_shipped_lesson_can_be_done() {
    let mut seen = 0;
    for file in plans::FILES {
        let plan = file.read().unwrap();
        for knee in plan.knees.iter().filter(|knee| knee.preset != "healthy") {
            let preset = preset::find(&knee.preset).unwrap();
            let speed_deg_s = match &knee.target {
                Some(name) => match Target::find(name).unwrap().aim {
                    Aim::Speed { low_deg_per_s, .. } => low_deg_per_s,
                    Aim::Metronome { .. } => panic!("{}: a metronome has no speed", file.name),
                },
                None => FASTEST_DEG_S,
            };
            for sign in signs(&preset.effect_settings(), preset.joint().is_some()) {
                let least_deg_s = sign.appears_from_deg_s();
                let name = (file.name, &knee.preset, sign.effect);
                assert!(least_deg_s <= speed_deg_s, "{name:?}: {least_deg_s} °/s");
                seen += 1;
            }
        }
    }
    assert!(seen >= 20, "{seen} signs");
}

#[test]
fn the_six_blind_knees_are_of_different_disorders() {
    let plan = plans::find("blind-six").unwrap().read().unwrap();
    let plan = plan.check(known()).unwrap();
    let found = |finding: &Finding| plan.knees().iter().any(|k| k.disorder == Some(*finding));
    assert_eq!(
        (plan.knees().len(), Finding::all().filter(found).count()),
        (6, 6)
    );
    assert!(found(&Finding::Healthy));
}

#[test]
fn what_is_left_out_has_its_default() {
    let plan = check("title = \"x\"\n[[knee]]\npreset = \"mas-2-catch\"\n").unwrap();
    let Plan {
        description,
        instruction,
        blind,
        curves,
        feedback,
        repeats,
        ..
    } = plan.plan();
    assert_eq!(
        (description.as_str(), instruction, *repeats),
        ("", &None, 1)
    );
    assert_eq!((*blind, *curves, *feedback), (false, false, Feedback::Each));
    let knee = &plan.knees()[0];
    assert_eq!(knee.title, "Spasticity, MAS 2, as an examiner feels it");
    assert_eq!(knee.disorder, Some(Finding::Disorder(Disorder::Spasticity)));
    assert_eq!(knee.level, Some(Level::Moderate));
}

#[test]
fn the_page_sends_the_same_as_json() {
    let toml = "title = \"x\"\nblind = true\nfeedback = \"end\"\n\
        [[knee]]\npreset = \"mine\"\ntarget = \"slow\"\ntime_s = 60.0\n[[knee]]\npreset = \"healthy\"\n";
    let json = json!({
        "title": "x", "instruction": null, "blind": true, "curves": false, "feedback": "end",
        "knees": [
            { "preset": "mine", "instruction": null, "target": "slow", "time_s": 60 },
            { "preset": "healthy" },
        ],
    });
    let plan = Plan::from_json(json).unwrap();
    assert_eq!(plan, Plan::from_toml(toml).unwrap());
    let plan = plan.check(known()).unwrap();
    assert_eq!(plan.knees()[1], Knee::healthy());
    assert_eq!(plan.knees()[0].title, "A knee of mine");
}

#[test]
fn mistakes_are_named_with_what_to_do() {
    let long = format!(
        "title = \"{}\"\n[[knee]]\npreset = \"fine\"\n",
        "x".repeat(61)
    );
    for (text, parts) in [
        ("title = \"x\"\n", &["`knee`"][..]),
        ("[[knee]]\npreset = \"fine\"\n", &["`title`"]),
        (
            "title = 1\n[[knee]]\npreset = \"fine\"\n",
            &["line 1", "string"],
        ),
        (
            "title = \"\"\n[[knee]]\npreset = \"fine\"\n",
            &["`title`", "1 to 60"],
        ),
        (&long, &["`title`", "61", "shorten"]),
        (
            "title = \"x\"\nblnd = true\n[[knee]]\npreset = \"fine\"\n",
            &["line 2", "`blnd`", "`blind`"],
        ),
        (
            "title = \"x\"\n[[knee]]\npreset = \"fine\"\ntime = 3\n",
            &["line 4", "`time`", "`time_s`"],
        ),
        (
            "title = \"x\"\nfeedback = \"now\"\n[[knee]]\npreset = \"fine\"\n",
            &["`now`", "`each`"],
        ),
        (
            "title = \"x\"\n[[knee]]\npreset = \"mas-2-katch\"\n",
            &["knee 1", "did you mean \"mas-2-catch\"", "crepitus presets"],
        ),
        (
            "title = \"x\"\n[[knee]]\npreset = \"fine\"\n[[knee]]\npreset = \"a quite different thing\"\n",
            &["knee 2", "no preset \"a quite different thing\";"],
        ),
        (
            "title = \"x\"\nblind = true\n[[knee]]\npreset = \"nameless\"\n",
            &["nameless", "add `disorder`"],
        ),
        (
            "title = \"x\"\n[[knee]]\npreset = \"fine\"\ntarget = \"sluw\"\n",
            &["knee 1", "target speed \"sluw\""],
        ),
        (
            "title = \"x\"\n[[knee]]\npreset = \"fine\"\ntime_s = 0\n",
            &["`time_s` is 0", "3600"],
        ),
        (
            "title = \"x\"\n[[knee]]\npreset = \"fine\"\ntime_s = nan\n",
            &["`time_s` is NaN"],
        ),
        (
            "title = \"x\"\nrepeats = 0\n[[knee]]\npreset = \"fine\"\n",
            &["1 knees, 0 times", "200"],
        ),
        (
            "title = \"x\"\nrepeats = 201\n[[knee]]\npreset = \"fine\"\n",
            &["201 times", "`repeats`"],
        ),
        ("title = \"x\"\nknee = []\n", &["0 knees"]),
    ] {
        let error = check(text).expect_err(text).to_string();
        for part in parts {
            assert!(error.contains(part), "{text}{part}: {error}");
        }
    }
    let error =
        Plan::from_json(json!({ "title": "x", "knees": [{ "preset": "fine", "tempo": 1 }] }));
    assert!(error.unwrap_err().to_string().contains("`tempo`"));
}

#[test]
fn an_open_lesson_takes_a_knee_without_a_disorder() {
    let plan = check("title = \"x\"\n[[knee]]\npreset = \"nameless\"\n").unwrap();
    assert_eq!(plan.knees()[0].disorder, None);
}

#[test]
fn repeats_can_be_changed_within_the_limit() {
    let plan = check("title = \"x\"\n[[knee]]\npreset = \"fine\"\n[[knee]]\npreset = \"coarse\"\n")
        .unwrap();
    assert_eq!(plan.clone().repeated(100).unwrap().plan().repeats, 100);
    for repeats in [0, 101, usize::MAX] {
        let error = plan.clone().repeated(repeats).unwrap_err();
        assert_eq!(error, PlanError::Trials { knees: 2, repeats });
    }
}

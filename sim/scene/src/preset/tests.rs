mod mistakes;

use super::*;
use crate::scene::{Overrides, Scene};
use crepitus_model::control::device_limits::RangeSettings;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::friction_compensation::{
    FrictionCompensationSettings, least_left_nm,
};
use crepitus_model::render::effects::range_limit::EndFeel;
use crepitus_model::render::turn_back::most_rad_per_count;

fn parse(text: &str) -> Result<Preset, SceneError> {
    Preset::parse(Path::new("mine.toml"), text)
}

fn number(preset: &str, effect: &str, key: &str) -> f64 {
    let preset = find(preset).unwrap();
    let effect = preset.effects().find(|e| e.name == effect).unwrap();
    let settings = preset.settings_of(effect);
    match settings.iter().find(|(k, _)| *k == key).unwrap().1 {
        Setting::Number(x, _) => x,
        Setting::Option(name) => panic!("{key} is {name}"),
    }
}

#[test]
fn every_file_of_the_folder_ships() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../presets");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    let mut names: Vec<_> = FILES.iter().map(|f| format!("{}.toml", f.name)).collect();
    names.sort();
    assert_eq!(files, names);
    assert_eq!(shipped().len(), FILES.len());
}

#[test]
fn every_preset_says_what_it_is() {
    let mut last = Disorder::ALL[0];
    for preset in shipped() {
        let name = &preset.name;
        for text in [
            &preset.title,
            &preset.severity,
            &preset.feel,
            &preset.source,
        ] {
            assert!(text.is_some(), "{name}");
        }
        assert!(preset.evidence.is_some(), "{name}");
        assert!(!preset.values.is_empty(), "{name}");
        assert!(preset.values.iter().all(|v| v.evidence.is_some()), "{name}");
        let disorder = preset.disorder.unwrap();
        let words: &[&str] = match disorder {
            Disorder::EndFeel => &["end-feel-"],
            Disorder::RangeDeficit => &["contracture-", "capsular", "stiff-knee", "-block"],
            Disorder::Rigidity => &["-lead-pipe"],
            Disorder::Cogwheel => &["-cogwheel"],
            Disorder::Spasticity => &["mas-"],
            Disorder::ClaspKnife => &["clasp-knife-"],
            Disorder::Clonus => &["-clonus"],
            Disorder::Texture => &["texture-"],
            // The names that scenes had before there was another disorder.
            Disorder::Crepitus => &["fine", "coarse", "bone-on-bone"],
        };
        assert!(words.iter().any(|word| name.contains(word)), "{name}");
        // In the order of the groups.
        let place = |d| Disorder::ALL.iter().position(|other| *other == d);
        assert!(place(last) <= place(disorder), "{name}");
        last = disorder;
    }
}

#[test]
fn every_joint_among_them_is_one_that_a_device_renders() {
    let count_rad = EncoderSettings::default().rad_per_count();
    let most = FrictionCompensationSettings::TABLE[1].max;
    let left_nm = (1.0 - most) * FrictionCompensationSettings::default().friction_nm;
    let names: Vec<_> = joints().iter().map(|joint| joint.name).collect();
    assert_eq!(names, ["coarse", "fine", "bone-on-bone"]);
    assert_eq!(joints()[0].parameters, Parameters::default());
    for preset in shipped() {
        let (Some(crepitus), name) = (&preset.crepitus, &preset.name) else {
            continue;
        };
        let p = &crepitus.settings.parameters;
        // Below, friction would push the leg.
        assert!(p.restart_torque_nm() >= 0.0, "{name}");
        // The guard keeps its bound with room; 7, 3 and 21 mN·m keep a hand quiet.
        let margin = most_rad_per_count(&crepitus.settings) / count_rad;
        assert!(margin > 2.5, "{name}: {margin}");
        assert!(2.0 * least_left_nm(p, 210.4e-6, 0.061) < left_nm, "{name}");
    }
}

#[test]
fn none_asks_for_more_than_the_device_shows_but_where_it_adds_up_or_grows() {
    let over: Vec<_> = shipped()
        .iter()
        .filter_map(|p| Some((p.name.as_str(), p.caps_warning()?)))
        .collect();
    let expected = [
        // What is left of a fast catch, 3.2 N·m, and 2 N·m/rad over 120°.
        ("mas-3-catch", "the symptom can ask for 7.4 N·m"),
        ("texture-bone-on-bone", "5.1 N·m together"),
    ];
    assert_eq!(over.len(), expected.len(), "{over:?}");
    for ((name, warning), (expected, words)) in over.iter().zip(expected) {
        assert_eq!(*name, expected);
        assert!(warning.contains(words), "{warning}");
    }
}

#[test]
fn capsular_is_firm_in_extension_and_soft_in_flexion() {
    let ends = |name: &str| {
        let settings = find(name).unwrap().effect_settings().range_limit.unwrap();
        (settings.extension(), settings.flexion())
    };
    let (extension, flexion) = ends("capsular");
    assert_eq!(extension, ends("end-feel-firm").0);
    assert_eq!(flexion, ends("end-feel-soft").1);
    // Of a knee that bends to 140 degrees.
    let capsular = find("capsular").unwrap().effect_settings();
    let limits = capsular.range_limit.unwrap();
    let deficits = limits.extension_limit_deg / (140.0 - limits.flexion_limit_deg);
    assert!((deficits - 0.29).abs() < 5e-3, "{deficits}");
    let cap_deg = |feel: EndFeel| feel.cap_rad().to_degrees();
    for (name, deg, spring) in [
        ("end-feel-soft", 6.9, 85.0),
        ("end-feel-firm", 2.9, 143.0),
        ("end-feel-hard", 0.76, 400.0),
        ("end-feel-springy", 3.8, 60.0),
    ] {
        for feel in [ends(name).0, ends(name).1] {
            let found = cap_deg(feel);
            assert!((found - deg).abs() < 0.05, "{name}: {found}");
            let k = feel.spring_nm_per_rad();
            assert!((k / spring - 1.0).abs() < 0.01, "{name}: {k}");
        }
    }
}

/// Beyond, the device's torque fades to nothing, so an end there would be weaker than its preset says.
#[test]
fn every_end_has_its_whole_torque_within_a_devices_range() {
    let range = RangeSettings::default();
    let whole = range.least_deg + range.fade_deg..=range.most_deg - range.fade_deg;
    for preset in shipped() {
        let (Some(ends), name) = (preset.effect_settings().range_limit, &preset.name) else {
            continue;
        };
        let cap_deg = |feel: EndFeel| feel.cap_rad().to_degrees();
        let extension_deg = ends.extension_limit_deg - cap_deg(ends.extension());
        assert!(whole.contains(&extension_deg), "{name}: {extension_deg}");
        let flexion_deg = ends.flexion_limit_deg + cap_deg(ends.flexion());
        let is_free = ends.flexion_limit_deg >= range.most_deg;
        assert!(
            is_free || whole.contains(&flexion_deg),
            "{name}: {flexion_deg}"
        );
    }
}

#[test]
fn a_source_names_whom_a_sourced_number_is_from() {
    for (kind, author) in [
        ("-reflex", "De Groote"),
        ("mas-4-lead-pipe", "De Groote"),
        ("capsular", "Riener and Edrich"),
    ] {
        for preset in shipped().iter().filter(|p| p.name.contains(kind)) {
            let source = preset.source.as_deref().unwrap();
            assert!(source.contains(author), "{}: {source}", preset.name);
        }
    }
}

#[test]
fn grades_of_a_scale_rise() {
    let rising: [(&str, &str, &[&str]); 6] = [
        (
            "lead-pipe",
            "torque_nm",
            &[
                "updrs-1-lead-pipe",
                "updrs-2-lead-pipe",
                "updrs-3-lead-pipe",
                "updrs-4-lead-pipe",
                "mas-4-lead-pipe",
            ],
        ),
        (
            "cogwheel",
            "torque_nm",
            &[
                "updrs-1-cogwheel",
                "updrs-2-cogwheel",
                "updrs-3-cogwheel",
                "updrs-4-cogwheel",
            ],
        ),
        (
            "spasticity",
            "velocity_torque_nms_per_rad",
            &[
                "mas-1-catch",
                "mas-1plus-catch",
                "mas-2-catch",
                "mas-3-catch",
            ],
        ),
        (
            "spasticity",
            "gain_nm_per_rad",
            &[
                "mas-1-reflex",
                "mas-1plus-reflex",
                "mas-2-reflex",
                "mas-3-reflex",
            ],
        ),
        (
            "clasp-knife",
            "slope_nm_per_rad",
            &[
                "clasp-knife-mild",
                "clasp-knife-marked",
                "clasp-knife-severe",
            ],
        ),
        (
            "texture",
            "peak_nm",
            &["texture-fine", "texture-coarse", "texture-bone-on-bone"],
        ),
    ];
    for (effect, key, names) in rising {
        let numbers: Vec<_> = names.iter().map(|name| number(name, effect, key)).collect();
        assert!(numbers.is_sorted_by(|a, b| a < b), "{names:?}: {numbers:?}");
    }
    // Both forms of a grade have one threshold.
    for grade in ["1", "1plus", "2", "3"] {
        let threshold = |form: &str| {
            let name = format!("mas-{grade}-{form}");
            number(&name, "spasticity", "threshold_deg")
        };
        assert_eq!(threshold("catch"), threshold("reflex"), "{grade}");
    }
}

#[test]
fn what_a_preset_builds_on_keeps_its_evidence() {
    let preset = find("texture-bone-on-bone").unwrap();
    let of = |effect: &str, key: &str| {
        let value = preset.value(effect, key).unwrap();
        (value.setting, value.evidence.unwrap())
    };
    let (Setting::Number(limit, spec), evidence) = of("range-limit", "extension_limit_deg") else {
        panic!("a number is expected")
    };
    assert_eq!(
        (limit, spec.unit, evidence),
        (10.0, "deg", Evidence::Sourced)
    );
    assert_eq!(
        of("range-limit", "flexion_stiffness_nm_per_rad").1,
        Evidence::Derived
    );
    assert_eq!(of("range-limit", "flexion_loss").1, Evidence::Estimate);
    // What no file gives is at its default, and not said to be the preset's.
    assert_eq!(preset.value("range-limit", "flexion_torque_nm"), None);
    assert_eq!(preset.value("texture", "seed"), None);
}

#[test]
fn a_fragment_is_a_preset() {
    let preset = parse("[effects.texture]\nseed = 7\n[effects.crepitus]\npreset = \"fine\"\nrestart = \"from-kinetic\"\n").unwrap();
    assert_eq!(
        (preset.name.as_str(), &preset.title, preset.evidence),
        ("mine", &None, None)
    );
    assert!(preset.has("texture") && preset.has("crepitus") && !preset.has("clonus"));
    let restart = preset.value("crepitus", "restart").unwrap();
    assert_eq!(restart.setting, Setting::Option("from-kinetic"));
    assert_eq!(preset.joint(), find("fine").unwrap().joint());
}

fn scene(effects: &str) -> Result<Scene, SceneError> {
    let toml = format!(
        "version = 1\ntitle = \"x\"\nduration_s = 1\n\
         [motion]\nkind = \"constant\"\nvelocity_rad_s = 1\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n{effects}"
    );
    Scene::parse(Path::new("x.toml"), &toml, &Overrides::default())
}

#[test]
fn a_scene_takes_the_values_of_every_preset() {
    for preset in shipped() {
        let tables = preset.effects().fold(String::new(), |tables, e| {
            tables + &format!("[effects.{}]\npreset = \"{}\"\n", e.name, preset.name)
        });
        let scene = scene(&tables).unwrap();
        assert_eq!(scene.effect_settings(), preset.effect_settings());
        let joint = scene.crepitus.as_ref().map(|c| &c.settings.parameters);
        assert_eq!(joint, preset.joint());
        let name = scene.crepitus.as_ref().map(|c| c.preset);
        let expected = preset.crepitus.as_ref().map(|_| Some(preset.name.as_str()));
        assert_eq!(name, expected);
        // What was run can be run again, to the bit.
        let again = Scene::parse(Path::new("x.toml"), &scene.as_run, &Overrides::default());
        assert_eq!(again.unwrap().effect_settings(), scene.effect_settings());
        let first = preset.effects().next().unwrap().name;
        assert!(scene.as_run.contains(&format!("[effects.{first}]")));
    }
}

#[test]
fn a_scene_replaces_single_values_of_a_preset() {
    let scene = scene(
        "[effects.range-limit]\npreset = \"capsular\"\nflexion_limit_deg = 90\nloss = 0.2\n\
         [effects.spasticity]\npreset = \"mas-3-catch\"\nmuscles = \"flexors\"\n",
    )
    .unwrap();
    let settings = scene.effect_settings();
    let (wall, muscle) = (settings.range_limit.unwrap(), settings.spasticity.unwrap());
    assert_eq!(
        (wall.extension_limit_deg, wall.flexion_limit_deg),
        (10.0, 90.0)
    );
    assert_eq!((wall.extension_loss, wall.flexion_loss), (0.2, 0.2));
    assert_eq!(wall.flexion_stiffness_nm_per_rad, 15.0);
    assert_eq!((muscle.muscles, muscle.threshold_deg), (1, 50.0));
}

#[test]
fn a_scene_names_presets_that_have_the_effect() {
    for (effects, parts) in [
        (
            "[effects.clonus]\npreset = \"mas-2-catch\"\n",
            &[
                "line 11: `effects.clonus.preset`",
                "allowed are scats-1-clonus",
                "your own presets",
            ][..],
        ),
        (
            "[effects.clonus]\npreset = 3\n",
            &["`effects.clonus.preset`", "a text in quotes"],
        ),
        (
            "[effects.encoder]\npreset = \"fine\"\n",
            &["`effects.encoder.preset`", "no such key"],
        ),
        (
            "[effects.lead-pipe]\npreset = \"updrs-2-lead-pip\"\n",
            &["did you mean updrs-2-lead-pipe?"],
        ),
    ] {
        let error = scene(effects).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn a_level_is_read_and_written() {
    for level in Level::ALL {
        let text = format!("level = \"{}\"\n\n[effects.texture]\n", level.name());
        let preset = parse(&text).unwrap();
        assert_eq!(preset.level, Some(level));
        assert_eq!(parse(&preset.to_toml()).unwrap().level, Some(level));
    }
    assert_eq!(parse("[effects.texture]\n").unwrap().level, None);
    for (wrong, part) in [
        ("\"marked\"", "allowed are mild, moderate and severe"),
        ("2", "a text in quotes is wanted"),
    ] {
        let text = format!("level = {wrong}\n[effects.clonus]\n");
        let error = parse(&text).unwrap_err().to_string();
        assert!(error.contains("line 1: `level`"), "{error}");
        assert!(error.contains(part), "{error}");
    }
    for preset in shipped() {
        let again = parse(&preset.to_toml()).unwrap();
        assert_eq!(again.level, preset.level, "{}", preset.name);
    }
}

/// Every grade has the level of the table in `docs/symptoms.md`; kinds have none.
#[test]
fn graded_presets_have_the_level_of_their_grade() {
    use Level::{Mild, Moderate, Severe};
    let levels = [
        ("MAS 1:", Mild),
        ("MAS 1+:", Mild),
        ("MAS 2:", Moderate),
        ("MAS 3:", Severe),
        ("MAS 4:", Severe),
        ("UPDRS 1:", Mild),
        ("UPDRS 2:", Moderate),
        ("UPDRS 3:", Severe),
        ("UPDRS 4:", Severe),
        ("SCATS 1:", Mild),
        ("SCATS 2:", Moderate),
        ("SCATS 3:", Severe),
        ("slight:", Mild),
        ("mild:", Mild),
        ("moderate", Moderate),
        ("marked:", Moderate),
        ("severe:", Severe),
    ];
    for preset in shipped() {
        let severity = preset.severity.as_deref().unwrap();
        let grade = levels.iter().find(|(word, _)| severity.starts_with(word));
        assert_eq!(preset.level, grade.map(|(_, l)| *l), "{}", preset.name);
        let kinds = ["end-feel-", "capsular", "stiff-knee", "-block"];
        let is_kind = kinds.iter().any(|kind| preset.name.contains(kind));
        assert_eq!(preset.level.is_none(), is_kind, "{}", preset.name);
    }
}

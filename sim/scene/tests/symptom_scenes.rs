//! The symptoms besides crepitus in scenes, stepped at 20 kHz and by `reference`,
//! against cases that an event-driven solver computed with 60 digits.

use crepitus_scene::run::columns;
use crepitus_scene::trace::SymptomEvent;
use crepitus_scene::{Observer, Overrides, Scene, run, shipped};
use serde_json::Value;
use std::convert::Infallible;
use std::fmt::Write;
use std::path::Path;

/// A case as a scene, and what is known of it.
struct Case {
    name: String,
    scene: String,
    json: Value,
}

/// A number, or one in a text.
fn number(value: &Value) -> f64 {
    match value {
        Value::String(text) => text.parse().expect("a decimal number"),
        other => other.as_f64().expect("a number"),
    }
}

fn motion(json: &Value, text: &mut String) -> std::fmt::Result {
    let rad_s = |deg: &Value| number(deg).to_radians();
    writeln!(text, "[motion]\nfrom_deg = {:?}", number(&json["from_deg"]))?;
    match json["kind"].as_str().unwrap() {
        "constant" => {
            let velocity = rad_s(&json["velocity_deg_s"]);
            writeln!(text, "kind = \"constant\"\nvelocity_rad_s = {velocity:?}")
        }
        "velocity-knots" => {
            writeln!(text, "kind = \"velocity-knots\"")?;
            for knot in json["knots"].as_array().unwrap() {
                writeln!(text, "[[motion.knots]]\nt_s = {:?}", number(&knot["t_s"]))?;
                if knot["left"].is_null() {
                    writeln!(text, "omega_rad_s = {:?}", rad_s(&knot["deg_s"]))?;
                } else {
                    let (left, right) = (rad_s(&knot["left"]), rad_s(&knot["right"]));
                    writeln!(
                        text,
                        "omega_left_rad_s = {left:?}\nomega_right_rad_s = {right:?}"
                    )?;
                }
            }
            Ok(())
        }
        other => panic!("unknown motion {other}"),
    }
}

fn effects(json: &Value, text: &mut String) {
    for (effect, keys) in json.as_object().unwrap() {
        let _ = writeln!(text, "[effects.{effect}]");
        for (key, value) in keys.as_object().unwrap() {
            let value = value.as_str().unwrap();
            let _ = match value.parse::<f64>() {
                Ok(x) => writeln!(text, "{key} = {x:?}"),
                Err(_) => writeln!(text, "{key} = \"{value}\""),
            };
        }
    }
}

fn case(path: &Path, solver: &str) -> Case {
    let json: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut scene = format!(
        "version = 1\ntitle = \"a case\"\nduration_s = {:?}\n",
        number(&json["t_end"])
    );
    let mut text = String::new();
    motion(&json["motion"], &mut text).unwrap();
    scene.push_str(&text);
    let _ = writeln!(scene, "[solver]\n{solver}\n[output]\nplay_events = true");
    effects(&json["effects"], &mut scene);
    Case {
        name: json["name"].as_str().unwrap().to_owned(),
        scene,
        json,
    }
}

#[derive(Default)]
struct Keep {
    rows: Vec<Vec<f64>>,
    events: Vec<SymptomEvent>,
}

impl Observer for Keep {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.events.push(*event);
        Ok(())
    }
}

/// The worst deviations of a case: s, N·m at events, N·m at ticks.
fn compare(case: &Case, worst: (f64, f64)) -> (f64, f64, f64) {
    let scene = Scene::parse(Path::new("case.toml"), &case.scene, &Overrides::default())
        .unwrap_or_else(|error| panic!("{}: {error}\n{}", case.name, case.scene));
    let mut keep = Keep::default();
    let Ok(_) = run(&scene, &mut keep) else {
        panic!("{}: did not run", case.name);
    };
    let name = &case.name;
    let expected = case.json["events"].as_array().unwrap();
    let words: Vec<_> = expected
        .iter()
        .map(|e| e["type"].as_str().unwrap())
        .collect();
    let found: Vec<_> = keep.events.iter().map(|e| e.word.name()).collect();
    assert_eq!(found, words, "{name}: {:#?}", keep.events);
    let (mut late_s, mut event_nm) = (0.0_f64, 0.0_f64);
    for (event, expected) in keep.events.iter().zip(expected) {
        let error_s = (event.time_s - number(&expected["t"])).abs();
        assert!(
            error_s <= worst.0,
            "{name}: {event:?} {error_s:e} s: {expected}"
        );
        late_s = late_s.max(error_s);
        for (nm, key) in [
            (event.torque_before_nm, "torque_before"),
            (event.torque_after_nm, "torque_after"),
        ] {
            let error_nm = (nm - number(&expected[key])).abs();
            assert!(
                error_nm <= worst.1,
                "{name}: {event:?} {error_nm:e}: {expected}"
            );
            event_nm = event_nm.max(error_nm);
        }
    }
    let names = columns(&scene);
    let sum: Vec<usize> = (0..names.len())
        .filter(|i| names[*i].name.ends_with("_nm") && names[*i].name != "hand_torque_nm")
        .collect();
    let mut tick_nm = 0.0_f64;
    for sample in case.json["samples"].as_array().unwrap() {
        let tick = usize::try_from(sample["tick"].as_u64().unwrap()).unwrap();
        let nm: f64 = sum.iter().map(|i| keep.rows[tick][*i]).sum();
        let error_nm = (nm - number(&sample["torque"])).abs();
        assert!(error_nm <= worst.1, "{name}: tick {tick}: {nm} {sample}");
        tick_nm = tick_nm.max(error_nm);
    }
    (late_s, event_nm, tick_nm)
}

fn all(solver: &str, worst: (f64, f64)) {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference-cases/disorders");
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .expect("the folder of cases")
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 8, "{paths:?}");
    for path in paths {
        let case = case(&path, solver);
        let (late_s, event_nm, tick_nm) = compare(&case, worst);
        println!(
            "{:40} {:30} {late_s:8.1e} s {event_nm:8.1e} N·m at events {tick_nm:8.1e} at ticks",
            solver.replace('\n', ", "),
            case.name
        );
    }
}

/// Solver of a scene with steps on the device's ticks, in this precision.
fn stepped(precision: &str) -> String {
    format!("kind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"{precision}\"")
}

#[test]
fn in_f64_events_and_torques_are_those_of_60_digits() {
    all(&stepped("f64"), (1e-9, 5e-6));
}

#[test]
fn in_f32_they_are_within_what_24_bits_allow() {
    all(&stepped("f32"), (1e-6, 5e-5));
}

#[test]
fn the_reference_of_a_scene_has_them_without_steps() {
    all("kind = \"reference\"", (1e-9, 1e-9));
}

#[test]
fn what_happens_after_the_last_row_of_the_reference_is_an_event_too() {
    // At 1 rad/s the wall is 20° ahead.
    let text = "version = 1\ntitle = \"a rest\"\nduration_s = 0.37\n\
                [motion]\nkind = \"constant\"\nfrom_deg = 100.0\nvelocity_rad_s = 1.0\n\
                [solver]\nkind = \"reference\"\n[output]\ntrace_step_s = 0.1\n\
                [effects.range-limit]\nflexion_limit_deg = 120.0\n";
    let scene = Scene::parse(Path::new("rest.toml"), text, &Overrides::default()).unwrap();
    let mut keep = Keep::default();
    let Ok(_) = run(&scene, &mut keep) else {
        panic!("it did not run");
    };
    assert_eq!(keep.rows.last().unwrap()[0], 0.3);
    let [contact] = keep.events.as_slice() else {
        panic!("{:?}", keep.events);
    };
    assert_eq!(contact.word.name(), "contact");
    let late_s = contact.time_s - 20.0_f64.to_radians();
    assert!(late_s.abs() < 1e-9, "{contact:?}");
}

#[test]
fn symptoms_that_ask_for_more_than_the_device_shows_are_warned_of() {
    let warned = |device: bool, torque_nm: f64| {
        let text = format!(
            "version = 1\ntitle = \"a sum\"\nduration_s = 1.0\ndevice = {device}\n\
             [motion]\nkind = \"constant\"\nvelocity_rad_s = 0.1\n[solver]\n{}\n\
             [effects.range-limit]\n[effects.lead-pipe]\ntorque_nm = {torque_nm}\n",
            stepped("f32")
        );
        let scene = Scene::parse(Path::new("sum.toml"), &text, &Overrides::default()).unwrap();
        let mut warnings = scene.warnings.iter();
        warnings.any(|warning| warning.contains("5.2 N·m together"))
    };
    assert!(warned(true, 1.2));
    assert!(!warned(true, 0.5));
    assert!(!warned(false, 1.2));
}

#[test]
fn a_growing_torque_is_warned_of() {
    let warned = |of_lead_pipe: &str| {
        let text = format!(
            "version = 1\ntitle = \"a slope\"\nduration_s = 1.0\ndevice = true\n\
             [motion]\nkind = \"constant\"\nvelocity_rad_s = 0.1\n[solver]\n{}\n\
             [effects.lead-pipe]\ntorque_nm = 1.2\nneutral_deg = 45.0\n{of_lead_pipe}\n",
            stepped("f32")
        );
        let scene = Scene::parse(Path::new("slope.toml"), &text, &Overrides::default()).unwrap();
        scene.warnings
    };
    // 75° from its neutral angle the spring has 3.93 N·m.
    let warnings = warned("elastic_nm_per_rad = 3.0");
    let words = "the symptom can ask for 5.1 N·m, and the device shows 4.5 N·m at most";
    assert!(warnings.iter().any(|w| w.contains(words)), "{warnings:?}");
    let below = warned("elastic_nm_per_rad = 2.5");
    assert!(
        !below.iter().any(|w| w.contains("can ask for")),
        "{below:?}"
    );
}

/// Words and times of the teeth of the shipped examination.
fn teeth(overrides: &Overrides) -> Vec<(&'static str, f64)> {
    let scene = shipped::scene(Path::new("cogwheel-examination"), overrides).unwrap();
    let mut keep = Keep::default();
    let Ok(_) = run(&scene, &mut keep) else {
        panic!("it did not run");
    };
    let own = keep.events.iter().filter(|e| !e.word.is_of_play());
    own.map(|e| (e.word.name(), e.time_s)).collect()
}

/// In the scene the leg turns back at 2.2 s, half way between two edges.
#[test]
fn no_tooth_of_the_examination_is_lost_in_f32() {
    let of = |solver: &str, precision: Option<&str>| {
        teeth(&Overrides {
            solver: Some(solver.to_owned()),
            precision: precision.map(str::to_owned),
            ..Overrides::default()
        })
    };
    let exact = of("reference", None);
    assert!(
        exact.iter().any(|(_, t)| (t - 2.24).abs() < 1e-9),
        "{exact:?}"
    );
    for precision in ["f64", "f32"] {
        let found = of("exact-events", Some(precision));
        let words = |list: &[(&'static str, f64)]| -> Vec<_> {
            list.iter().map(|(word, _)| *word).collect()
        };
        assert_eq!(words(&found), words(&exact), "{precision}: {found:?}");
        for ((word, found_s), (_, exact_s)) in found.iter().zip(&exact) {
            let off_s = (found_s - exact_s).abs();
            assert!(off_s < 1e-6, "{precision}: {word} at {found_s}, {exact_s}");
        }
    }
}

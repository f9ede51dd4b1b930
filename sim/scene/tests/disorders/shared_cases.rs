//! Cases computed with 60 digits by a program that shares no code with this
//! one: files of schema `disorder-events/1`.

use crate::support::{Given, TIME_S, TORQUE_NM, constant, jumps, symptom};
use crepitus_plant::Motion;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn number(value: &Value) -> f64 {
    match value {
        Value::String(s) => s.parse().expect("a decimal number"),
        other => other.as_f64().expect("a number"),
    }
}

fn cases() -> Vec<PathBuf> {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference-cases/disorders");
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .expect("the folder of cases")
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 8, "{paths:?}");
    paths
}

fn motion(value: &Value) -> Motion {
    let n = |name: &str| number(&value[name]);
    match value["kind"].as_str().unwrap() {
        "constant" => constant(n("from_deg"), n("velocity_deg_s")),
        "velocity-knots" => {
            let knots = value["knots"].as_array().unwrap().iter();
            let knots: Vec<_> = knots
                .map(|k| {
                    let one = |name: &str| k.get(name).or(k.get("deg_s")).map(number).unwrap();
                    (number(&k["t_s"]), one("left"), one("right"))
                })
                .collect();
            jumps(n("from_deg"), &knots)
        }
        other => panic!("unknown motion {other}"),
    }
}

fn keys(value: &Value) -> Given {
    let mut given = Given::default();
    for (key, value) in value.as_object().unwrap() {
        let text = value.as_str().unwrap();
        match text.parse() {
            Ok(number) => given.numbers.push((key.clone(), number)),
            Err(_) => given.choices.push((key.clone(), text.to_owned())),
        }
    }
    given
}

#[test]
fn every_event_and_torque_of_every_shared_case() {
    for path in cases() {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let json: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let (effect, numbers) = json["effects"].as_object().unwrap().iter().next().unwrap();
        let motion = motion(&json["motion"]);
        let given = keys(numbers);
        let end_s = number(&json["t_end"]);
        let found = symptom(effect, &given, &motion).advance(end_s);
        let expected = json["events"].as_array().unwrap();
        let sequence: Vec<_> = found.iter().map(|e| e.kind.name()).collect();
        let words: Vec<_> = expected
            .iter()
            .map(|e| e["type"].as_str().unwrap())
            .collect();
        assert_eq!(sequence, words, "{name}");

        let (mut time, mut other, mut torque) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (e, x) in found.iter().zip(expected) {
            let off = |found: f64, key: &str| (found - number(&x[key])).abs();
            time = time.max(off(e.time_s, "t"));
            other = other.max(off(e.angle_rad, "angle"));
            other = other.max(off(e.omega_rad_s, "omega"));
            torque = torque.max(off(e.torque_before_nm, "torque_before"));
            torque = torque.max(off(e.torque_after_nm, "torque_after"));
            assert_eq!(e.peak_nm.is_some(), x.get("peak").is_some(), "{name}");
            if let Some(peak_nm) = e.peak_nm {
                torque = torque.max(off(peak_nm, "peak"));
            }
        }
        let mut sampled = 0.0_f64;
        let mut symptom = symptom(effect, &given, &motion);
        for sample in json["samples"].as_array().unwrap() {
            symptom.advance(number(&sample["t"]));
            sampled = sampled.max((symptom.torque_nm() - number(&sample["torque"])).abs());
        }
        println!(
            "{name:28} {:3} events, worst {time:.1e} s {other:.1e} rad, rad/s {torque:.1e} N·m, \
             samples {sampled:.1e} N·m",
            found.len()
        );
        assert!(time <= TIME_S && other <= 1e-8, "{name}");
        assert!(torque <= TORQUE_NM && sampled <= TORQUE_NM, "{name}");
    }
}

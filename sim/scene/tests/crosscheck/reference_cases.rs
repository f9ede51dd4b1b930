//! The second solver against the cases computed with 50 digits.

use crate::double_double::Dd;
use crate::solver::{Problem, solve};
use crepitus_model::{Convention, EventKind, Parameters, Settings};
use crepitus_plant::Motion;
use crepitus_plant::motion::VelocityKnot;
use serde_json::Value;
use std::path::Path;

/// A decimal of up to 22 digits with all of them.
fn decimal(text: &str) -> Dd {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let mut exponent: i32 = exponent.parse().unwrap();
    let (mut value, mut fraction) = (Dd::ZERO, false);
    for c in mantissa.trim_start_matches('-').chars() {
        match c.to_digit(10) {
            Some(digit) => {
                value = value * 10.0 + Dd::new(f64::from(digit));
                exponent -= i32::from(fraction);
            }
            None => fraction = true,
        }
    }
    for _ in 0..exponent.abs() {
        value = if exponent > 0 {
            value * 10.0
        } else {
            value / Dd::new(10.0)
        };
    }
    if mantissa.starts_with('-') {
        -value
    } else {
        value
    }
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a decimal string")
}

fn number(value: &Value) -> f64 {
    text(value).parse().expect("a number")
}

fn motion(drive: &Value) -> Motion {
    let d = |name: &str| number(&drive[name]);
    match text(&drive["kind"]) {
        "const" => Motion::constant(d("Omega")),
        "sine_position" => Motion::sine(d("A"), d("f_hz"), 0.0),
        "minus_cosine_position" => Motion::sine(d("A"), d("f_hz"), -90.0),
        "piecewise_linear_velocity" => {
            let knots: Vec<_> = drive["knots"]
                .as_array()
                .unwrap()
                .iter()
                .map(|k| VelocityKnot {
                    time_s: number(&k["t"]),
                    omega_left_rad_s: number(&k["Omega_left"]),
                    omega_right_rad_s: number(&k["Omega_right"]),
                })
                .collect();
            Motion::velocity_knots(&knots)
        }
        other => panic!("unknown drive {other}"),
    }
}

fn settings(json: &Value) -> Settings {
    let p = |name: &str| number(&json["params"][name]);
    Settings {
        parameters: Parameters {
            inertia_kg_m2: p("J"),
            stiffness_nm_per_rad: p("kr"),
            damping_nms_per_rad: p("c"),
            kinetic_torque_nm: p("Tk"),
            static_torque_nm: p("Ts"),
        },
        convention: match text(&json["convention"]) {
            "frozen" => Convention::Frozen,
            "paper" => Convention::Paper,
            "physical" => Convention::Physical,
            other => panic!("unknown convention {other}"),
        },
        ..Settings::default()
    }
}

#[test]
fn every_event_of_every_case() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference-cases");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    assert_eq!(paths.len(), 43, "the reference cases");
    let (mut wrong, mut all) = (Vec::new(), 0);
    for path in paths {
        let json: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let name = text(&json["name"]);
        let settings = settings(&json);
        let motion = motion(&json["drive"]);
        let history = match solve(Problem {
            settings: &settings,
            motion: &motion,
            duration_s: number(&json["t_end"]),
            most_events: usize::MAX,
        }) {
            Ok(history) => history,
            Err(why) => {
                wrong.push(format!("{name}: {why}"));
                continue;
            }
        };
        let every = json["events"].as_array().unwrap();
        let (touches, expected): (Vec<_>, Vec<_>) =
            every.iter().partition(|e| e["type"] == "touch");
        let sense = |e: &Value, key: &str| i8::try_from(e[key].as_i64().unwrap()).unwrap();
        let of_kind = |kind: EventKind| match kind {
            EventKind::Break => "break",
            EventKind::Stick => "stick",
            EventKind::Reverse => "reverse",
        };
        let sequence: Vec<_> = (history
            .events
            .iter()
            .map(|e| (of_kind(e.kind), e.from, e.to)))
        .collect();
        let right: Vec<_> = (expected.iter())
            .map(|e| {
                (
                    text(&e["type"]),
                    sense(e, "phase_from"),
                    sense(e, "phase_to"),
                )
            })
            .collect();
        all += expected.len();
        if sequence != right || history.touches_s.len() != touches.len() {
            wrong.push(format!(
                "{name}: {} events for {}",
                sequence.len(),
                right.len()
            ));
            continue;
        }
        let mut worst = [0.0_f64; 4];
        for (found, e) in history.events.iter().zip(&expected) {
            let error = |x: Dd, key: &str| {
                (e[key].as_str()).map_or(0.0, |d| (x - decimal(d)).abs().to_f64())
            };
            let errors = [
                error(found.time_s, "t"),
                error(found.theta_rad, "theta"),
                error(found.torque_before_nm.unwrap_or_default(), "torque_before"),
                error(found.torque_after_nm, "torque_after"),
            ];
            worst = std::array::from_fn(|i| worst[i].max(errors[i]));
        }
        let [time, theta, before, after] = worst;
        println!(
            "{name:32} {:4} events, worst errors {time:.1e} s {theta:.1e} rad {before:.1e} {after:.1e} N·m",
            expected.len()
        );
        for (touch, right) in history.touches_s.iter().zip(&touches) {
            let error = (touch - number(&right["t"])).abs();
            if error > 1e-13 {
                wrong.push(format!("{name}: a touch is {error:e} s off"));
            }
        }
        // Their files have 22 digits. Knots become pieces with slopes and
        // angles in f64, which is the same problem to 16 digits only.
        let knots = text(&json["drive"]["kind"]) == "piecewise_linear_velocity";
        let rounded = if knots { 1e5 } else { 1.0 };
        let within = |error: f64, bound: f64| error <= bound * rounded;
        if !(within(time, 1e-21)
            && within(theta, 1e-23)
            && within(before, 1e-20)
            && within(after, 1e-20))
        {
            wrong.push(format!("{name}: {worst:?}"));
        }
    }
    println!("{all} events");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

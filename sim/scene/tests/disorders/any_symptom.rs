//! Properties that hold for every symptom.

use crate::support::{Given, TORQUE_NM, constant, events, given, jumps, near, symptom, words};
use crepitus_plant::Motion;
use crepitus_plant::motion::Strokes;
use crepitus_plant::piece::Curve;
use crepitus_scene::reference::symptoms::{Symptom, SymptomError, Word as Kind};

/// Every symptom, with flexors where it has muscles.
fn all(flexors: bool) -> Vec<(&'static str, Given)> {
    let muscles = if flexors { "flexors" } else { "extensors" };
    let s = if flexors { -1.0 } else { 1.0 };
    let limits = |low: f64, high: f64| {
        given(
            &[
                ("extension_limit_deg", low),
                ("flexion_limit_deg", high),
                ("loss", 0.2),
                (
                    if flexors {
                        "extension_torque_nm"
                    } else {
                        "flexion_torque_nm"
                    },
                    3.0,
                ),
            ],
            &[],
        )
    };
    let muscle = |numbers: &[(&str, f64)], form: &str| {
        let choices = [("muscles", muscles), ("form", form)];
        given(numbers, &choices)
    };
    vec![
        (
            "range-limit",
            if flexors {
                limits(-45.0, 35.0)
            } else {
                limits(-35.0, 45.0)
            },
        ),
        (
            "lead-pipe",
            given(
                &[("elastic_nm_per_rad", 2.0), ("neutral_deg", s * 20.0)],
                &[],
            ),
        ),
        ("cogwheel", given(&[("neutral_deg", s * 20.0)], &[])),
        (
            "spasticity",
            muscle(&[("threshold_deg", s * 40.0)], "catch"),
        ),
        (
            "spasticity",
            muscle(&[("threshold_deg", s * 40.0)], "reflex"),
        ),
        (
            "clasp-knife",
            muscle(
                &[("onset_deg", s * 5.0), ("release_deg", s * 40.0)],
                "catch",
            ),
        ),
        ("clonus", muscle(&[("hold_deg", s * 10.0)], "catch")),
        ("texture", given(&[("irregularity", 0.0)], &[])),
    ]
}

pub(crate) fn motions() -> Vec<Motion> {
    vec![
        Motion::sine(0.9, 0.8, 20.0),
        jumps(
            3.3,
            &[
                (0.0, 0.0, 0.0),
                (0.3, 280.0, -150.0),
                (0.8, 30.0, 110.0),
                (1.4, -90.0, -90.0),
            ],
        ),
        Motion::Strokes(Strokes {
            from_rad: -0.8,
            to_rad: 0.95,
            peak_speed_rad_s: 5.0,
            pause_s: 0.1,
        }),
    ]
}

fn negated(motion: &Motion) -> Motion {
    match motion {
        Motion::Single(piece) => {
            let Curve::Sine {
                centre_rad,
                amplitude_rad,
                frequency_hz,
                phase_turns,
            } = piece.curve
            else {
                panic!("a sine");
            };
            Motion::sine(-amplitude_rad, frequency_hz, 360.0 * phase_turns).shifted(-centre_rad)
        }
        Motion::Sequence(pieces) => {
            let mut pieces = pieces.clone();
            for piece in &mut pieces {
                if let Curve::Polynomial(c) = &mut piece.curve {
                    *c = c.map(|c| -c);
                }
            }
            Motion::Sequence(pieces)
        }
        Motion::Strokes(strokes) => Motion::Strokes(Strokes {
            from_rad: -strokes.from_rad,
            to_rad: -strokes.to_rad,
            ..*strokes
        }),
        Motion::Cycle(_) => panic!("none is among the motions"),
    }
}

#[test]
fn flexors_are_the_mirror_image_of_extensors() {
    let mut count = 0;
    for motion in &motions() {
        let mirror = negated(motion);
        for ((name, keys), (_, other)) in all(false).iter().zip(all(true)) {
            let found = events(name, keys, motion, 4.0);
            let image = events(name, &other, &mirror, 4.0);
            assert_eq!(words(&found), words(&image), "{name} {motion:?}");
            for (a, b) in found.iter().zip(&image) {
                near(a.time_s, b.time_s, 1e-12);
                near(a.angle_rad, -b.angle_rad, 1e-12);
                near(a.omega_rad_s, -b.omega_rad_s, 1e-12);
                near(a.torque_before_nm, -b.torque_before_nm, 1e-12);
                near(a.torque_after_nm, -b.torque_after_nm, 1e-12);
            }
            count += found.len();
        }
    }
    assert!(count > 300, "{count}");
}

/// The elastic torque and the limit are computed apart: where one meets the
/// other both are the same, as exactly as the time is.
#[test]
fn a_play_meets_and_leaves_its_limits_without_a_jump() {
    let mut count = 0;
    for motion in &motions() {
        for (name, keys) in all(false) {
            for e in events(name, &keys, motion, 4.0) {
                if matches!(e.kind, Kind::Flow | Kind::Turn | Kind::Slack | Kind::Take) {
                    near(e.torque_before_nm, e.torque_after_nm, 1e-12);
                    count += 1;
                }
                let shaft = motion.at(e.time_s);
                near(e.angle_rad, shaft.phi_rad, 1e-14);
                near(e.omega_rad_s, shaft.omega_rad_s, 1e-12);
            }
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn events_do_not_depend_on_how_often_the_torque_is_asked_for() {
    for motion in &motions() {
        for (name, keys) in all(false) {
            let once = events(name, &keys, motion, 4.0);
            let mut often = Vec::new();
            let mut symptom = symptom(name, &keys, motion);
            for n in 1..=4000_u32 {
                often.extend(symptom.advance(1e-3 * f64::from(n)));
                assert!(symptom.torque_nm().is_finite());
            }
            assert_eq!(words(&once), words(&often), "{name}");
            for (a, b) in once.iter().zip(&often) {
                assert_eq!(a.time_s.to_bits(), b.time_s.to_bits(), "{name}");
            }
        }
    }
}

#[test]
fn a_long_run_repeats_itself() {
    let motion = Motion::sine(0.9, 1.0, 20.0);
    for (name, keys) in all(false) {
        if matches!(name, "clonus" | "cogwheel") {
            continue;
        }
        let mut symptom = symptom(name, &keys, &motion);
        symptom.advance(10.0);
        let early = symptom.advance(11.0);
        symptom.advance(1000.0);
        let late = symptom.advance(1001.0);
        assert_eq!(words(&early), words(&late), "{name}");
        for (a, b) in early.iter().zip(&late) {
            near(b.time_s - a.time_s, 990.0, 1e-9);
            near(b.torque_before_nm, a.torque_before_nm, TORQUE_NM);
        }
    }
}

#[test]
fn a_joint_that_rests_has_no_events() {
    for (name, keys) in all(false) {
        let motion = constant(2.0, 0.0);
        let mut symptom = symptom(name, &keys, &motion);
        assert!(symptom.advance(1e6).is_empty(), "{name}");
    }
}

#[test]
fn what_no_law_can_take_is_refused() {
    let motion = constant(0.0, 1.0);
    let build = |name: &str, keys: Given| Symptom::new(name, &keys, &motion).err();
    assert_eq!(
        build("crepitus", given(&[], &[])),
        Some(SymptomError::Unknown("crepitus".to_owned()))
    );
    for (name, key, value) in [
        ("range-limit", "loss", 1.0),
        ("range-limit", "extension_loss", -0.1),
        ("range-limit", "flexion_stiffness_nm_per_rad", 0.0),
        ("range-limit", "flexion_limit_deg", 10.0),
        ("lead-pipe", "presliding_deg", 0.0),
        ("lead-pipe", "torque_nm", f64::NAN),
        ("cogwheel", "frequency_hz", 0.0),
        ("cogwheel", "low_share", 1.5),
        ("spasticity", "release_s", 0.0),
        ("spasticity", "threshold_deg", f64::INFINITY),
        ("clasp-knife", "release_deg", 20.0),
        ("clonus", "frequency_hz", -1.0),
        ("texture", "peak_nm", 0.05),
        ("texture", "stiffness_nm_per_rad", 1.0),
        ("texture", "seed", 0.5),
    ] {
        let error = build(name, given(&[(key, value)], &[]));
        let Some(SymptomError::Number { key: found, .. }) = &error else {
            panic!("{name} {key}: {error:?}");
        };
        assert_eq!(found, key);
    }
    let error = build("clasp-knife", given(&[], &[("muscles", "flexors")]));
    assert!(matches!(error, Some(SymptomError::Number { .. })));
    let error = build("clonus", given(&[], &[("muscles", "both")])).unwrap();
    assert_eq!(
        error.to_string(),
        "clonus: muscles = \"both\": expected one of extensors, flexors"
    );
}

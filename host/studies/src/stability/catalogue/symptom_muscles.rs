//! `spasticity`, `clasp-knife` and `clonus` where a muscle is easily got wrong.

use super::symptom_tools::{
    ON_TIME, as_the_reference, exactly, renders_symptoms, seen_in_counts, times, torque, trial,
    under,
};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Criterion, Limits};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;

/// Allowed lateness of a catch behind counts, s.
const CAUGHT_WITHIN: Limits = Limits::both(0.01);

fn catch() -> Given {
    Given::new("spasticity", &[], &[("form", "catch")])
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H67",
        name: "catch-dither",
        title: "A stretch that dithers about the threshold velocity, also seen in counts",
        hard: "38 and 42 deg/s in turn where 40 is the threshold: each passage would be a catch. The state is single-shot: one \
               catch, and none until the leg has come back by 10°. Behind the encoder a count is 0.64 deg/s of noise, \
               which may only shift the moment.",
        source: "docs/symptoms.md, spasticity",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let dither: Vec<(f64, f64)> = (0..16_u32)
                .map(|n| {
                    let up = if n.is_multiple_of(2) { 38.0 } else { 42.0 };
                    (f64::from(n) / 10.0, up)
                })
                .collect();
            let hand = Hand::ramps(45.0, &dither);
            let [events, torques] = as_the_reference();
            vec![
                trial(
                    under(&catch(), hand.clone(), 1.5),
                    [events, torques, Criterion::Words(&[Word::Catch])],
                ),
                trial(
                    seen_in_counts(under(&catch(), hand, 1.5)),
                    [Criterion::Words(&[Word::Catch])],
                ),
            ]
        },
    },
    Case {
        id: "H68",
        name: "catch-order",
        title: "A slow passage and then a faster one, a retreat that is too short, and noise",
        hard: "Angle and velocity have to hold together, whichever comes last: beyond the angle already, the muscle is caught where the \
               velocity is reached. A retreat short of 10° is no second catch, one of 10.1° is.",
        source: "docs/symptoms.md, spasticity: caught at 40 deg/s, after 1.5 s; within 10 ms behind counts",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let faster = Hand::ramps(60.0, &[(0.0, 20.0), (1.0, 20.0), (2.0, 60.0)]);
            let retreat = |back_s: f64| {
                Hand::jumps(30.0, &[(0.0, 100.0), (0.3, -100.0), (0.4 + back_s, 100.0)])
            };
            let slow = Hand::Constant {
                from_deg: 20.0,
                deg_s: 30.0,
            };
            let [events, torques] = as_the_reference();
            vec![
                trial(
                    under(&catch(), faster.clone(), 2.0),
                    [events, torques, Criterion::Words(&[Word::Catch])],
                ),
                trial(
                    under(&catch(), retreat(0.099), 1.0),
                    exactly(&[Word::Catch]),
                ),
                trial(
                    under(&catch(), retreat(0.101), 1.0),
                    exactly(&[Word::Catch, Word::Rearm, Word::Catch]),
                ),
                trial(
                    under(&catch(), slow, 3.0),
                    [torque(0.0, 0.0, 0.0, 0.0), Criterion::Words(&[])],
                ),
            ]
        },
    },
    Case {
        id: "H69",
        name: "catch-counts",
        title: "MAS 2 at 90 and 130 deg/s behind the encoder",
        hard: "The estimate of the velocity is 6.4 ms late, and shifts the angle of a catch by μ times its error. At a steady \
               stretch that must not be seen: caught once, where it should be within 10 ms.",
        source: "docs/symptoms.md, spasticity: caught at 52.5° and 42.5°, after 361 and 173 ms",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            [(90.0, 32.5 / 90.0), (130.0, 22.5 / 130.0)]
                .map(|(deg_s, at_s)| {
                    let hand = Hand::Constant {
                        from_deg: 20.0,
                        deg_s,
                    };
                    trial(
                        seen_in_counts(under(&catch(), hand, 0.6)),
                        [
                            Criterion::Words(&[Word::Catch]),
                            Criterion::FirstWord {
                                word: Word::Catch,
                                at_s,
                                within_s: CAUGHT_WITHIN,
                            },
                        ],
                    )
                })
                .to_vec()
        },
    },
    Case {
        id: "H70",
        name: "blade-turned-back",
        title: "A clasp-knife turned back a degree short of its release, crept through, and tried again",
        hard: "Turned back at 74° it has not fallen, and the resistance must be there again on the way to 75°. Crept through at \
               0.5 deg/s, a step is 4e-7 rad. Once it has fallen there is no second blade after a retreat of 30°; there is one \
               after 56°, below the onset by 10°.",
        source: "docs/symptoms.md, clasp-knife",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let given = Given::new("clasp-knife", &[], &[]);
            let back = Hand::jumps(20.0, &[(0.0, 60.0), (0.9, -60.0), (1.2, 60.0)]);
            let creep = Hand::jumps(29.0, &[(0.0, 60.0), (0.75, 0.5)]);
            let again =
                |back_s: f64| Hand::jumps(20.0, &[(0.0, 60.0), (1.0, -60.0), (1.1 + back_s, 60.0)]);
            let released_early = Given::new(
                "clasp-knife",
                &[
                    ("catch_stiffness_nm_per_rad", 10.0),
                    ("release_deg", 33.0),
                    ("onset_torque_nm", 0.8),
                ],
                &[],
            );
            let through = Hand::Constant {
                from_deg: 29.0,
                deg_s: 60.0,
            };
            let [events, torques] = as_the_reference();
            vec![
                trial(
                    under(&given, back, 1.6),
                    exactly(&[Word::Onset, Word::Release]),
                ),
                // 2 s of creep: a release is as late as the angle is rounded.
                trial(
                    under(&given, creep, 3.0),
                    exactly(&[Word::Onset, Word::Release]),
                ),
                trial(
                    under(&given, again(0.5), 3.5),
                    [events.clone(), times(Word::Release, 1)],
                ),
                trial(
                    under(&given, again(0.95), 4.0),
                    [events, torques, times(Word::Release, 2)],
                ),
                trial(
                    under(&released_early, through, 0.5),
                    exactly(&[Word::Onset, Word::Release]),
                ),
            ]
        },
    },
    Case {
        id: "H71",
        name: "clonus-passed",
        title: "A slow crossing that is passed over, and a stretch that ends in a beat",
        hard: "Crossed slowly and then made faster beyond it, the angle of clonus is passed over until the leg has come back. Let go \
               in the middle of a beat there is no further one, and the one under way runs out instead of falling to zero.",
        source: "docs/symptoms.md, clonus",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let given = Given::new("clonus", &[], &[]);
            let passed = Hand::ramps(
                55.5,
                &[
                    (0.0, 50.0),
                    (0.2, 50.0),
                    (0.3, 200.0),
                    (0.4, 0.0),
                    (0.5, 0.0),
                ],
            );
            let released = Hand::jumps(50.0, &[(0.0, 200.0), (0.1, -250.0), (0.3, 0.0)]);
            let held = Hand::jumps(50.0, &[(0.0, 200.0), (0.1, 0.0)]);
            // 3 ms of a beat of 97.5 ms are still to come where it stops: it is not cut off.
            let slope = Criterion::TorqueStep { most_nm: 0.003 };
            vec![
                trial(
                    under(&given, passed, 0.6),
                    [torque(0.0, 0.0, 0.0, 0.0), Criterion::Words(&[])],
                ),
                trial(
                    under(&given, released, 1.0),
                    [
                        Criterion::SymptomEvents { within_s: ON_TIME },
                        Criterion::Words(&[Word::Start, Word::Beat, Word::Stop]),
                        slope,
                    ],
                ),
                trial(
                    under(&given, held, 1.0),
                    exactly(&[
                        Word::Start,
                        Word::Beat,
                        Word::Beat,
                        Word::Beat,
                        Word::Beat,
                        Word::Beat,
                    ]),
                ),
            ]
        },
    },
];

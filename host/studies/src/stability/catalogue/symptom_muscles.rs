//! `spasticity`, `clasp-knife` and `clonus` where a muscle is easily got wrong.

use super::symptom_tools::{
    ON_TIME, SYMPTOM, as_the_reference, exactly, in_counts, plain, steady, times, under,
};
use crate::stability::case::Case;
use crate::stability::criteria::{first_word, symptom_events, torque, torque_step, words};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;

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
        trials: |_| {
            let dither: Vec<(f64, f64)> = (0..16_u32)
                .map(|n| {
                    let up = if n.is_multiple_of(2) { 38.0 } else { 42.0 };
                    (f64::from(n) / 10.0, up)
                })
                .collect();
            let hand = Hand::ramps(45.0, &dither);
            vec![
                under(&catch(), hand.clone(), 1.5).meets(exactly(&[Word::Catch])),
                in_counts(&catch(), hand, 1.5).meets([words(&[Word::Catch])]),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H68",
        name: "catch-order",
        title: "A slow passage and then a faster one, a retreat that is too short, and noise",
        hard: "Angle and velocity have to hold together, whichever comes last: beyond the angle already, the muscle is caught where the \
               velocity is reached. A retreat short of 10° is no second catch, one of 10.1° is.",
        source: "docs/symptoms.md, spasticity: caught at 40 deg/s, after 1.5 s; within 10 ms behind counts",
        trials: |_| {
            let faster = Hand::ramps(60.0, &[(0.0, 20.0), (1.0, 20.0), (2.0, 60.0)]);
            let retreat = |back_s: f64| {
                Hand::jumps(30.0, &[(0.0, 100.0), (0.3, -100.0), (0.4 + back_s, 100.0)])
            };
            let silent = [torque(0.0, 0.0, 0.0, 0.0), words(&[])];
            let twice = exactly(&[Word::Catch, Word::Rearm, Word::Catch]);
            vec![
                under(&catch(), faster, 2.0).meets(exactly(&[Word::Catch])),
                under(&catch(), retreat(0.099), 1.0).meets(exactly(&[Word::Catch])),
                under(&catch(), retreat(0.101), 1.0).meets(twice),
                under(&catch(), steady(20.0, 30.0), 3.0).meets(silent),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H69",
        name: "catch-counts",
        title: "MAS 2 at 90 and 130 deg/s behind the encoder",
        hard: "The estimate of the velocity is 6.4 ms late, and shifts the angle of a catch by μ times its error. At a steady \
               stretch that must not be seen: caught once, where it should be within 10 ms.",
        source: "docs/symptoms.md, spasticity: caught at 52.5° and 42.5°, after 361 and 173 ms",
        trials: |_| {
            [(90.0, 32.5 / 90.0), (130.0, 22.5 / 130.0)]
                .map(|(deg_s, at_s)| {
                    let once = words(&[Word::Catch]);
                    let on_time = first_word(Word::Catch, at_s, 0.01);
                    in_counts(&catch(), steady(20.0, deg_s), 0.6).meets([once, on_time])
                })
                .into()
        },
        ..SYMPTOM
    },
    Case {
        id: "H70",
        name: "blade-turned-back",
        title: "A clasp-knife turned back a degree short of its release, crept through, and tried again",
        hard: "Turned back at 74° it has not fallen, and the resistance must be there again on the way to 75°. Crept through at \
               0.5 deg/s, a step is 4e-7 rad. Once it has fallen there is no second blade after a retreat of 30°; there is one \
               after 56°, below the onset by 10°.",
        source: "docs/symptoms.md, clasp-knife",
        trials: |_| {
            let given = plain("clasp-knife");
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
            let [events, torques] = as_the_reference();
            let fallen = || exactly(&[Word::Onset, Word::Release]);
            let once = [events.clone(), times(Word::Release, 1)];
            let twice = [events, torques, times(Word::Release, 2)];
            vec![
                under(&given, back, 1.6).meets(fallen()),
                // 2 s of creep: a release is as late as the angle is rounded.
                under(&given, creep, 3.0).meets(fallen()),
                under(&given, again(0.5), 3.5).meets(once),
                under(&given, again(0.95), 4.0).meets(twice),
                under(&released_early, steady(29.0, 60.0), 0.5).meets(fallen()),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H71",
        name: "clonus-passed",
        title: "A slow crossing that is passed over, and a stretch that ends in a beat",
        hard: "Crossed slowly and then made faster beyond it, the angle of clonus is passed over until the leg has come back. Let go \
               in the middle of a beat there is no further one, and the one under way runs out instead of falling to zero.",
        source: "docs/symptoms.md, clonus",
        trials: |_| {
            let given = plain("clonus");
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
            let runs_out = [
                symptom_events(ON_TIME),
                words(&[Word::Start, Word::Beat, Word::Stop]),
                // 3 ms of a beat of 97.5 ms are still to come where it stops: it is not cut off.
                torque_step(0.003),
            ];
            let beats = exactly(&[
                Word::Start,
                Word::Beat,
                Word::Beat,
                Word::Beat,
                Word::Beat,
                Word::Beat,
            ]);
            vec![
                under(&given, passed, 0.6).meets([torque(0.0, 0.0, 0.0, 0.0), words(&[])]),
                under(&given, released, 1.0).meets(runs_out),
                under(&given, held, 1.0).meets(beats),
            ]
        },
        ..SYMPTOM
    },
];

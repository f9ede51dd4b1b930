//! `lead-pipe`, `cogwheel` and `texture` where a play is easily got wrong.

use super::symptom_tools::{
    as_the_reference, renders_symptoms, seen_in_counts, times, torque, trial, under,
};
use crate::stability::case::{Case, located};
use crate::stability::criterion::Criterion;
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H62",
        name: "rigidity-turns",
        title: "Rigidity that only touches its limit, and a reversal with a rest in it",
        hard: "A hand that stops where the play has just reached its limit, and turns back, has not dragged it: nothing is lost. \
               A law with the sign of the velocity has two torques at rest; a play has the one that it came with.",
        source: "docs/symptoms.md, lead-pipe; the torque of the reference",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let given = Given::new("lead-pipe", &[], &[]);
            let touch = Hand::jumps(
                40.0,
                &[
                    (0.0, 10.0),
                    (0.15, 0.0),
                    (0.3, -10.0),
                    (0.4, 10.0),
                    (0.6, 0.0),
                ],
            );
            let rest = Hand::ramps(
                40.0,
                &[
                    (0.0, 50.0),
                    (0.2, 50.0),
                    (0.3, 0.0),
                    (0.7, 0.0),
                    (0.8, -50.0),
                    (1.2, -50.0),
                ],
            );
            let [events, torques] = as_the_reference();
            let stays = torque(0.31, -1.2, 1.2, 1e-6);
            vec![
                trial(under(&given, touch, 0.8), [torques.clone(), events]),
                trial(under(&given, rest, 1.2), [torques, stays]),
            ]
        },
    },
    Case {
        id: "H63",
        name: "cogwheel-rest",
        title: "A cogwheel whose hand stops: one give, and then silence",
        hard: "The clock of the teeth goes on while the hand rests. The first give lets the torque fall to the low level; the \
               catches after it change nothing, because torque rises only as the hand moves. Moved again, it is at the tooth \
               that the clock has come to.",
        source: "docs/symptoms.md, cogwheel; a give every 160 ms, 0.4 of 2 N·m",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let given = Given::new("cogwheel", &[], &[]);
            let stop = Hand::jumps(40.0, &[(0.0, 50.0), (0.06, 0.0)]);
            let on = Hand::jumps(40.0, &[(0.0, 50.0), (0.06, 0.0), (0.61, 50.0)]);
            vec![
                trial(
                    under(&given, stop.clone(), 10.0),
                    [
                        torque(0.081, 0.8, 0.8, 1e-6),
                        Criterion::Words(&[Word::Give]),
                    ],
                ),
                trial(
                    seen_in_counts(under(&given, stop, 10.0)),
                    // A count and the estimate of the velocity: σΔ = 3 mN·m.
                    [torque(0.081, 0.8, 0.8, 3e-3), times(Word::Give, 1)],
                ),
                trial(under(&given, on, 0.9), as_the_reference()),
            ]
        },
    },
    Case {
        id: "H64",
        name: "cogwheel-turns",
        title: "A reversal inside a catch, and a tremble across a tooth's edge",
        hard: "Turned back in a catch the torque has to come down along the spring and not at the next give. At an edge between two \
               teeth a tremble of a degree must not make the torque jump up, and a flickering count must not be a row of gives.",
        source: "docs/symptoms.md, cogwheel; 7.5° a tooth, an edge from high to low at 11.25°",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let by_time = Given::new("cogwheel", &[], &[]);
            let by_angle = Given::new("cogwheel", &[], &[("mode", "space")]);
            let turned = Hand::ramps(
                40.0,
                &[(0.0, 60.0), (0.19, 60.0), (0.21, -47.0), (0.6, -47.0)],
            );
            let tremble = |by_deg, frequency_hz| Hand::Tremble {
                from_deg: 8.0,
                deg_s: 22.0,
                at_deg: 11.25,
                by_deg,
                frequency_hz,
            };
            // At the edge the angle is within two counts of it: there is a give or not, and
            // not two. Two counts further on there is one.
            let flicker = |at_deg| {
                let hand = Hand::Tremble {
                    from_deg: 8.0,
                    deg_s: 22.0,
                    at_deg,
                    by_deg: 0.001_226,
                    frequency_hz: 700.0,
                };
                seen_in_counts(under(&by_angle, hand, 1.0))
            };
            vec![
                trial(under(&by_time, turned, 0.6), as_the_reference()),
                trial(
                    under(&by_angle, tremble(0.5, 3.0), 0.8),
                    [torque(0.2, -0.8, 0.8, 1e-4)],
                ),
                trial(
                    flicker(11.25),
                    [
                        torque(0.2, 0.8, 2.0, 5e-3),
                        Criterion::WordCount {
                            word: Word::Give,
                            least: 0,
                            most: 1,
                        },
                    ],
                ),
                trial(
                    flicker(11.2545),
                    [torque(0.2, 0.8, 0.8, 5e-3), times(Word::Give, 1)],
                ),
            ]
        },
    },
    Case {
        id: "H65",
        name: "texture-tremble",
        title: "A tremble on an asperity, and one that is met exactly as a tick ends",
        hard: "An asperity is a click when it is crossed at the limit. A hand that trembles on it crosses it again and again with less \
               torque: that is one snap. A tick that ends exactly on it, or a hand that stops there, must count it once, neither never nor twice.",
        source: "docs/symptoms.md, texture; an asperity every 1.5°, without irregularity",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let given = Given::new("texture", &[("irregularity", 0.0)], &[]);
            let tremble = |by_deg, frequency_hz| Hand::Tremble {
                from_deg: 1.0,
                deg_s: 10.0,
                at_deg: 1.5,
                by_deg,
                frequency_hz,
            };
            // 0.05 s is 1,000 ticks.
            let met =
                |then: f64| Hand::jumps(1.0, &[(0.0, 10.0), (0.05, 0.0), (0.1, then), (0.15, 0.0)]);
            vec![
                trial(
                    under(&given, tremble(0.1, 12.5), 0.8),
                    [Criterion::Words(&[Word::Snap])],
                ),
                trial(
                    seen_in_counts(under(&given, tremble(0.001_226, 700.0), 0.8)),
                    [Criterion::Words(&[Word::Snap])],
                ),
                trial(
                    under(&given, met(10.0), 0.2),
                    [Criterion::Words(&[Word::Snap])],
                ),
                // The hand turns back on the asperity: rounding says whether it was crossed.
                trial(
                    under(&given, met(-10.0), 0.2),
                    [Criterion::WordCount {
                        word: Word::Snap,
                        least: 0,
                        most: 1,
                    }],
                ),
                // 40 a second at 60 deg/s, each at a tick's end.
                trial(
                    under(
                        &given,
                        Hand::Constant {
                            from_deg: 0.0,
                            deg_s: 60.0,
                        },
                        1.001,
                    ),
                    [times(Word::Snap, 40)],
                ),
            ]
        },
    },
    Case {
        id: "H66",
        name: "texture-back",
        title: "The same asperities there and back, at irregular places",
        hard: "An asperity belongs to an angle: places and heights are a hash of its number, the same on the way back and after a turn \
               between two. A law that counts them as it goes loses one at the first reversal.",
        source: "docs/symptoms.md, texture; the snaps of the reference",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let given = Given::new("texture", &[("irregularity", 0.9), ("seed", 7.0)], &[]);
            let wander = Hand::Wander {
                about_deg: 20.0,
                deg_s: 120.0,
                seed: 3,
            };
            vec![trial(under(&given, wander, 3.0), as_the_reference())]
        },
    },
];

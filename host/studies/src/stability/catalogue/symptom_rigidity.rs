//! `lead-pipe`, `cogwheel` and `texture` where a play is easily got wrong.

use super::symptom_tools::{
    SYMPTOM, as_the_reference, in_counts, plain, steady, times, tremble, under, wander,
};
use crate::stability::case::Case;
use crate::stability::criteria::{torque, word_count, words};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;

/// 0.6 counts to either side, deg, 700 times a second.
const FLICKER: (f64, f64) = (0.001_226, 700.0);

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H62",
        name: "rigidity-turns",
        title: "Rigidity that only touches its limit, and a reversal with a rest in it",
        hard: "A hand that stops where the play has just reached its limit, and turns back, has not dragged it: nothing is lost. \
               A law with the sign of the velocity has two torques at rest; a play has the one that it came with.",
        source: "docs/symptoms.md, lead-pipe; the torque of the reference",
        trials: |_| {
            let given = plain("lead-pipe");
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
                under(&given, touch, 0.8).meets([torques.clone(), events]),
                under(&given, rest, 1.2).meets([torques, stays]),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H63",
        name: "cogwheel-rest",
        title: "A cogwheel whose hand stops: one give, and then silence",
        hard: "The clock of the teeth goes on while the hand rests. The first give lets the torque fall to the low level; the \
               catches after it change nothing, because torque rises only as the hand moves. Moved again, it is at the tooth \
               that the clock has come to.",
        source: "docs/symptoms.md, cogwheel; a give every 160 ms, 0.4 of 2 N·m",
        trials: |_| {
            let given = plain("cogwheel");
            let stop = Hand::jumps(40.0, &[(0.0, 50.0), (0.06, 0.0)]);
            let on = Hand::jumps(40.0, &[(0.0, 50.0), (0.06, 0.0), (0.61, 50.0)]);
            let low = torque(0.081, 0.8, 0.8, 1e-6);
            // A count and the estimate of the velocity: σΔ = 3 mN·m.
            let counted = torque(0.081, 0.8, 0.8, 3e-3);
            vec![
                under(&given, stop.clone(), 10.0).meets([low, words(&[Word::Give])]),
                in_counts(&given, stop, 10.0).meets([counted, times(Word::Give, 1)]),
                under(&given, on, 0.9).meets(as_the_reference()),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H64",
        name: "cogwheel-turns",
        title: "A reversal inside a catch, and a tremble across a tooth's edge",
        hard: "Turned back in a catch the torque has to come down along the spring and not at the next give. At an edge between two \
               teeth a tremble of a degree must not make the torque jump up, and a flickering count must not be a row of gives.",
        source: "docs/symptoms.md, cogwheel; 7.5° a tooth, an edge from high to low at 11.25°",
        trials: |_| {
            let by_time = plain("cogwheel");
            let by_angle = Given::new("cogwheel", &[], &[("mode", "space")]);
            let turned = Hand::ramps(
                40.0,
                &[(0.0, 60.0), (0.19, 60.0), (0.21, -47.0), (0.6, -47.0)],
            );
            let swing = tremble((8.0, 22.0), 11.25, (0.5, 3.0));
            // At the edge the angle is within two counts of it: there is a give or not, and
            // not two. Two counts further on there is one.
            let flicker = |at_deg| tremble((8.0, 22.0), at_deg, FLICKER);
            let maybe = [torque(0.2, 0.8, 2.0, 5e-3), word_count(Word::Give, 0, 1)];
            let once = [torque(0.2, 0.8, 0.8, 5e-3), times(Word::Give, 1)];
            vec![
                under(&by_time, turned, 0.6).meets(as_the_reference()),
                under(&by_angle, swing, 0.8).meets([torque(0.2, -0.8, 0.8, 1e-4)]),
                in_counts(&by_angle, flicker(11.25), 1.0).meets(maybe),
                in_counts(&by_angle, flicker(11.2545), 1.0).meets(once),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H65",
        name: "texture-tremble",
        title: "A tremble on an asperity, and one that is met exactly as a tick ends",
        hard: "An asperity is a click when it is crossed at the limit. A hand that trembles on it crosses it again and again with less \
               torque: that is one snap. A tick that ends exactly on it, or a hand that stops there, must count it once, neither never nor twice.",
        source: "docs/symptoms.md, texture; an asperity every 1.5°, without irregularity",
        trials: |_| {
            let given = Given::new("texture", &[("irregularity", 0.0)], &[]);
            let on_it = |by| tremble((1.0, 10.0), 1.5, by);
            // 0.05 s is 1,000 ticks.
            let met =
                |then: f64| Hand::jumps(1.0, &[(0.0, 10.0), (0.05, 0.0), (0.1, then), (0.15, 0.0)]);
            let snap = || [words(&[Word::Snap])];
            vec![
                under(&given, on_it((0.1, 12.5)), 0.8).meets(snap()),
                in_counts(&given, on_it(FLICKER), 0.8).meets(snap()),
                under(&given, met(10.0), 0.2).meets(snap()),
                // The hand turns back on the asperity: rounding says whether it was crossed.
                under(&given, met(-10.0), 0.2).meets([word_count(Word::Snap, 0, 1)]),
                // 40 a second at 60 deg/s, each at a tick's end.
                under(&given, steady(0.0, 60.0), 1.001).meets([times(Word::Snap, 40)]),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H66",
        name: "texture-back",
        title: "The same asperities there and back, at irregular places",
        hard: "An asperity belongs to an angle: places and heights are a hash of its number, the same on the way back and after a turn \
               between two. A law that counts them as it goes loses one at the first reversal.",
        source: "docs/symptoms.md, texture; the snaps of the reference",
        trials: |_| {
            let given = Given::new("texture", &[("irregularity", 0.9), ("seed", 7.0)], &[]);
            vec![under(&given, wander(20.0, 120.0, 3), 3.0).meets(as_the_reference())]
        },
        ..SYMPTOM
    },
];

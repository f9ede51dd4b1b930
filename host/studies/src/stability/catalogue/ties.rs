//! Inputs between two outcomes: velocities that just meet or just do not, and
//! events at one instant.

use super::tools::{CASE, MOVING, TICK_S, constant, knots};
use crate::stability::case::{Case, located};
use crate::stability::criteria::{EVENTS, count, events, exactly};
use crepitus_scene::scene::Precision;

type Knots = &'static [(f64, f64, f64)];

// From the break on Ω grows so fast that the object just fails to catch up
// with it, or just does; at 1 ± 1e-6 of that acceleration.
const FAST: [Knots; 2] = [
    &[
        (0.0, 1.0, 1.0),
        (0.001, 1.0, 1.0),
        (0.051, 1.008_066_414_508_198, 1.008_066_414_508_198),
    ],
    &[
        (0.0, 1.0, 1.0),
        (0.001, 1.0, 1.0),
        (0.051, 1.008_066_430_641_043_2, 1.008_066_430_641_043_2),
    ],
];
const SLOW: [Knots; 2] = [
    &[
        (0.0, 0.1, 0.1),
        (0.01, 0.1, 0.1),
        (0.06, 0.175_710_503_183_650_75, 0.175_710_503_183_650_75),
    ],
    &[
        (0.0, 0.1, 0.1),
        (0.01, 0.1, 0.1),
        (0.06, 0.175_710_654_604_808_54, 0.175_710_654_604_808_54),
    ],
];

const KNOT: Knots = &[(0.0, 1.0, 1.0), (0.001, 1.0, 1.0), (0.05, 1.005, 1.005)];
const JUMP: Knots = &[(0.0, 1.0, 1.0), (0.001, 1.0, 0.5), (0.05, 0.5, 0.5)];
const STILL: Knots = &[(0.0, 0.1, 0.1), (0.02, 0.0, 0.0), (0.05, 0.0, 0.0)];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H30",
        name: "grazing",
        title: "The shaft just outruns the object, or just does not",
        hard: "At the critical acceleration the velocities touch in a double root. A millionth to either side \
               decides whether there is a stick at all; f32 cannot distinguish them and is only shown.",
        source: "critical Ω̇ = 0.161328451492413 and 1.51421157788459 rad/s² by bisection with 40 digits",
        must: |subject| located(subject) && subject.precision == Precision::F64,
        trials: |_| {
            // Until just after the first match: 30.9 and 27.2 ms after the
            // break.
            let [fast, outran] = FAST.map(|shaft| knots(shaft, 0.0322));
            let [slow, crept_away] = SLOW.map(|shaft| knots(shaft, 0.0375));
            [(fast, 2), (outran, 1), (slow, 2), (crept_away, 1)]
                .map(|(input, number)| input.meets([exactly(EVENTS, number)]))
                .into()
        },
        ..MOVING
    },
    Case {
        id: "H31",
        name: "simultaneous",
        title: "A break exactly on a sample, on a knot, on a jump, and as the shaft stops",
        hard: "Two events at one instant: rounding puts the break on either side of the sample, and each side \
               could report it, or neither. The side may differ; the number must not.",
        source: "an event on a boundary is recorded once, whichever side it falls on",
        trials: |_| {
            vec![
                constant(1.0, 0.05).meets([events(TICK_S)]),
                knots(KNOT, 0.05).meets([events(TICK_S)]),
                // The break by torque and the tear by the jump: one or both.
                knots(JUMP, 0.002).meets([count(EVENTS, 1, 2)]),
                // At Ts with a shaft that stands: it may hold or slip once.
                knots(STILL, 0.05).meets([count(EVENTS, 0, 2)]),
            ]
        },
        ..CASE
    },
];

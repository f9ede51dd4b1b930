//! Inputs between two outcomes: velocities that just meet or just do not, and
//! events at one instant.

use super::tools::{TICK_S, at_tick, events, exactly, paper_joint, trial};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::Shaft;
use crate::stability::subject::Subject;
use crepitus_model::Convention;
use crepitus_scene::scene::Precision;

// From the break on Ω grows so fast that the object just fails to catch up
// with it, or just does; at 1 ± 1e-6 of that acceleration.
const FAST: [&[(f64, f64, f64)]; 2] = [
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
const SLOW: [&[(f64, f64, f64)]; 2] = [
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

const KNOT: &[(f64, f64, f64)] = &[(0.0, 1.0, 1.0), (0.001, 1.0, 1.0), (0.05, 1.005, 1.005)];
const JUMP: &[(f64, f64, f64)] = &[(0.0, 1.0, 1.0), (0.001, 1.0, 0.5), (0.05, 0.5, 0.5)];
const STILL: &[(f64, f64, f64)] = &[(0.0, 0.1, 0.1), (0.02, 0.0, 0.0), (0.05, 0.0, 0.0)];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H30",
        name: "grazing",
        title: "The shaft just outruns the object, or just does not",
        hard: "At the critical acceleration the velocities touch in a double root. A millionth to either side \
               decides whether there is a stick at all; f32 cannot distinguish them and is only shown.",
        source: "critical Ω̇ = 0.161328451492413 and 1.51421157788459 rad/s² by bisection with 40 digits",
        long: false,
        must: |subject| located(subject) && subject.precision == Precision::F64,
        trials: |subject| {
            if subject.convention == Convention::Frozen {
                return Vec::new();
            }
            // Until just after the first match: 30.9 and 27.2 ms after the
            // break.
            [(FAST, 0.0322), (SLOW, 0.0375)]
                .iter()
                .flat_map(|&([sticks, runs_away], duration_s)| {
                    [(sticks, 2), (runs_away, 1)].map(|(knots, count)| {
                        trial(
                            paper_joint(subject.convention),
                            at_tick(Shaft::Knots(knots), duration_s),
                            [exactly(Counted::Events, count)],
                        )
                    })
                })
                .collect()
        },
    },
    Case {
        id: "H31",
        name: "simultaneous",
        title: "A break exactly on a sample, on a knot, on a jump, and as the shaft stops",
        hard: "Two events at one instant: rounding puts the break on either side of the sample, and each side \
               could report it, or neither. The side may differ; the number must not.",
        source: "an event on a boundary is recorded once, whichever side it falls on",
        long: false,
        must: located,
        trials: |subject: Subject| {
            let settings = paper_joint(subject.convention);
            let few = |least, most| Criterion::Count {
                what: Counted::Events,
                least,
                most,
            };
            let within = events(Limits::both(TICK_S));
            let knots = |knots, duration_s| at_tick(Shaft::Knots(knots), duration_s);
            vec![
                trial(
                    settings,
                    at_tick(Shaft::Constant(1.0), 0.05),
                    [within.clone()],
                ),
                trial(settings, knots(KNOT, 0.05), [within]),
                // The break by torque and the tear by the jump: one or both.
                trial(settings, knots(JUMP, 0.002), [few(1, 2)]),
                // At Ts with a shaft that stands: it may hold or slip once.
                trial(settings, knots(STILL, 0.05), [few(0, 2)]),
            ]
        },
    },
];

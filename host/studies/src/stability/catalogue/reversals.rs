//! A shaft that turns back, jumps, stops and brakes.

use super::motions::{DWELL, STOP, THROUGH_ZERO, VELOCITY_JUMPS};
use super::tools::{
    LOCATED, SAMPLED, at_tick, events, exactly, knee, most_hz, paper_joint, sine, trial,
};
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::Shaft;
use crepitus_model::{Convention, Parameters};

/// Torque after an event on a motion that the steps describe exactly.
const TORQUE: Criterion = Criterion::EventTorques {
    within_nm: Limits {
        f64: 1e-9,
        f32: 1e-4,
    },
};

const SLOPES: [&[(f64, f64, f64)]; 3] = [
    &[(0.0, 3.15, 3.15), (0.3, -3.15, -3.15), (0.4, -3.15, -3.15)],
    &[(0.0, 3.1, 3.1), (0.2, -3.1, -3.1), (0.4, -3.1, -3.1)],
    &[(0.0, 5.0, 5.0), (0.01, -5.0, -5.0), (0.4, -5.0, -5.0)],
];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H04",
        name: "dwell",
        title: "Dwells at exactly zero speed, then turns back",
        hard: "Ω = 0 is neither sign: a slip that runs on must end by itself, a stick must hold, and the first \
               movement after the dwell decides the sense.",
        source: "tests/reference-cases, x22 and x22z, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let input = at_tick(Shaft::Knots(DWELL), 1.1);
            let criteria = [events(LOCATED), Criterion::NoBreakAtRest];
            vec![trial(paper_joint(subject.convention), input, criteria)]
        },
    },
    Case {
        id: "H05",
        name: "reversal-in-stick",
        title: "Turns back inside a stick, and never leaves it",
        hard: "In a stick the object follows by position. One that integrates velocity drifts, and its loop of \
               torque over angle does not close; near the limit the turn can be a break and its undoing in one step.",
        source: "tests/reference-cases, r11 and p12, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            // Ω̇ is known as the slope of a step, so the inertia's part of a
            // `physical` torque is half a step old: J·max|Ω̈|·h/2 = 5.6e-8.
            let rounding = if subject.convention == Convention::Physical {
                1e-7
            } else {
                1e-12
            };
            vec![
                trial(
                    settings,
                    at_tick(sine(0.003, 1.0), 3.0),
                    [events(SAMPLED), exactly(Counted::Events, 47)],
                ),
                trial(
                    settings,
                    at_tick(sine(0.0009, 1.0), 3.0),
                    [
                        exactly(Counted::Events, 0),
                        Criterion::TorqueReturns {
                            within_nm: Limits {
                                f64: rounding,
                                f32: 1e-6,
                            },
                        },
                        Criterion::LoopArea {
                            most_j: Limits::both(1e-12),
                        },
                    ],
                ),
            ]
        },
    },
    Case {
        id: "H06",
        name: "velocity-jumps",
        title: "Ω jumps by half a radian per second",
        hard: "A jump breaks a stick whatever its torque, and can reverse a slip at once; \
               the event belongs to the instant of the jump and the torque to the new sense.",
        source: "tests/reference-cases, q10, q10p and q10z, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let input = at_tick(Shaft::Knots(VELOCITY_JUMPS), 1.0);
            vec![trial(
                paper_joint(subject.convention),
                input,
                [events(LOCATED), TORQUE],
            )]
        },
    },
    Case {
        id: "H07",
        name: "through-zero",
        title: "Ω passes zero during a slip",
        hard: "Friction follows the velocity relative to the object, not the shaft's: a method that uses the sign of Ω \
               reverses the torque too early.",
        source: "tests/reference-cases, t09, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let mut criteria = vec![events(LOCATED), TORQUE];
            // Under `frozen` the object's velocity decides nothing.
            if subject.convention != Convention::Frozen {
                criteria.push(Criterion::SlipsWithShaft {
                    within_rad_s: Limits {
                        f64: 1e-12,
                        f32: 1e-6,
                    },
                });
            }
            let input = at_tick(Shaft::Knots(THROUGH_ZERO), 0.6);
            vec![Trial {
                settings: paper_joint(subject.convention),
                input,
                criteria,
            }]
        },
    },
    Case {
        id: "H16",
        name: "fast-swing",
        title: "45° at 2 Hz: the inertia alone exceeds Ts",
        hard: "J·Ω̇ is above Ts from the first instant, so there is no stick to start from, and a velocity match \
               needs three times the static limit: it must reverse, and never show that torque.",
        source: "tests/reference-cases, f19 and f19s, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let mut from_rest = trial(settings, at_tick(knee(2.0), 1.0), [events(SAMPLED)]);
            if subject.convention == Convention::Physical {
                from_rest.criteria.push(exactly(Counted::Reverses, 3));
            }
            let at_speed = sine(std::f64::consts::FRAC_PI_4, 2.0);
            vec![
                from_rest,
                trial(settings, at_tick(at_speed, 1.0), [events(SAMPLED)]),
            ]
        },
    },
    Case {
        id: "H17",
        name: "sudden-stop",
        title: "1 rad/s stops within 50 ms",
        hard: "The object keeps √(J·kr)·Ω = 2 N·m of swing, and a stick after the match needs 1.6 N·m, four times Ts. \
               What is shown must stay within Ts, and the ringing must end.",
        source: "tests/reference-cases, g20 and g20z, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let slip_s = std::f64::consts::TAU / settings.parameters.natural_rad_s();
            let mut stop = trial(
                settings,
                at_tick(Shaft::Knots(STOP), 2.0),
                [events(LOCATED)],
            );
            match subject.convention {
                // At most one slip outlasts the motion.
                Convention::Frozen => stop.criteria.push(Criterion::SilentAfter {
                    time_s: 1.05 + slip_s,
                }),
                Convention::Physical => {
                    stop.criteria
                        .push(Criterion::SilentAfter { time_s: 1.0922 });
                }
                Convention::Paper => {}
            }
            vec![stop]
        },
    },
    Case {
        id: "H18",
        name: "hard-braking",
        title: "The hand brakes harder than (Ts − Tk)/J = 20 rad/s²",
        hard: "The paper's torque leaves the inertia out, so a stick breaks although the object would at once be \
               faster than the shaft: it sticks again in the same instant, without end (Zeno). An encoder's \
               velocity decelerates that much at every count.",
        source: "J·Ω̇ against Ts − Tk in eq. (7)",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Paper {
                return Vec::new();
            }
            SLOPES
                .map(|knots| {
                    let settings = paper_joint(subject.convention);
                    let criteria = [
                        Criterion::EventsPerStep { most: 4 },
                        Criterion::EventsPerSecond {
                            most: 2.0 * most_hz(&Parameters::default()) + 2.0,
                        },
                    ];
                    trial(settings, at_tick(Shaft::Knots(knots), 0.4), criteria)
                })
                .to_vec()
        },
    },
];

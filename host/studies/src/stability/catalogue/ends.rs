//! Motions that end with the run, a shaft that comes to rest where the object
//! rests, and a step with more events than it may report.

use super::motions::{DWELL, STOP, WANDER};
use super::tools::{LOCATED, at_tick, events, joint, paper_joint, trial};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::Shaft;
use crepitus_model::Convention;
use crepitus_plant::motion::Strokes;

/// A recording of a second: one pass of a knee in eleven rows.
const ROWS: &[(f64, f64)] = &[
    (0.0, 0.0),
    (0.1, 0.03),
    (0.2, 0.12),
    (0.3, 0.26),
    (0.4, 0.4),
    (0.5, 0.46),
    (0.6, 0.4),
    (0.7, 0.26),
    (0.8, 0.12),
    (0.9, 0.03),
    (1.0, 0.0),
];

// Sliding at 0.3 rad/s, the damped object comes to rest within five seconds,
// also in f64; then the shaft stops, rests and continues.
const STOPS: &[(f64, f64, f64)] = &[
    (0.0, 0.3, 0.3),
    (5.0, 0.3, 0.3),
    (5.5, 0.0, 0.0),
    (6.0, 0.0, 0.0),
    (6.02, 0.02, 0.02),
    (6.1, 0.02, 0.02),
];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H48",
        name: "motion-ends-with-the-run",
        title: "The last knot, the last row and the last stroke are the end of the run",
        hard: "There is no piece after the last: a solver that asks for the piece after the end \
               gets the last one again and never finishes, or reads a velocity that no motion has. Mirrored, everything \
               must be the mirror image up to the last bit.",
        source: "a recording as long as its scene; the same for knots and strokes, by the reference",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let mut trials = vec![
                trial(
                    settings,
                    at_tick(Shaft::Knots(DWELL), 1.1),
                    [events(LOCATED)],
                ),
                trial(
                    settings,
                    at_tick(Shaft::Knots(STOP), 2.0),
                    [events(LOCATED)],
                ),
                trial(
                    settings,
                    at_tick(Shaft::Knots(WANDER), 1.05),
                    [events(LOCATED)],
                ),
            ];
            // 15/8 · 0.8 rad at 1.5 rad/s is one second a stroke.
            let strokes = |sign: f64| {
                Shaft::Strokes(Strokes {
                    from_rad: 0.0,
                    to_rad: sign * 0.8,
                    peak_speed_rad_s: 1.5,
                    pause_s: 0.0,
                })
            };
            let rows = |sign| Shaft::Rows {
                rows: ROWS,
                sign,
                cutoff_hz: 2.0,
            };
            for (shaft, mirrored, duration_s) in [
                (strokes(1.0), strokes(-1.0), 2.0),
                (rows(1.0), rows(-1.0), 1.0),
            ] {
                let mirror = Criterion::MirrorOf(at_tick(mirrored, duration_s));
                let slips = Criterion::Count {
                    what: Counted::Breaks,
                    least: 1,
                    most: 100,
                };
                trials.push(trial(settings, at_tick(shaft, duration_s), [mirror, slips]));
            }
            trials
        },
    },
    Case {
        id: "H49",
        name: "dead-object",
        title: "The shaft comes to rest exactly where the object has",
        hard: "Both velocities are zero from the same instant on: a tie. The slip has not been overtaken, and it has \
               nothing left to overtake. Either it ends there in a stick at Tk, or it goes on; both show Tk as long as \
               the shaft rests, and nothing else is allowed. Ours ends in a stick, as dry friction does, and the \
               next movement winds it to Ts.",
        source: "documented tie; from Tk to Ts is half a millirad, 35 ms after 6 s, and 27.5 ms where c·Ω helps",
        long: false,
        must: located,
        trials: |subject| {
            let at_s = match subject.convention {
                Convention::Frozen => return Vec::new(),
                Convention::Paper => 6.035,
                Convention::Physical => 6.027_5,
            };
            let settings = joint(subject.convention, [0.01, 400.0, 3.0, 0.2, 0.4]);
            let few = Criterion::Count {
                what: Counted::Events,
                least: 1,
                most: 2,
            };
            let at_rest = Criterion::TorqueWithin {
                from_s: 5.6,
                low_nm: 0.2,
                high_nm: 0.2,
                slack_nm: 1e-5,
            };
            let on = Criterion::FirstBreakAfter {
                from_s: 5.6,
                at_s,
                within_s: Limits::both(1e-4),
            };
            vec![
                trial(
                    settings,
                    at_tick(Shaft::Knots(STOPS), 5.9),
                    [few, at_rest, Criterion::NoBreakAtRest],
                ),
                trial(
                    settings,
                    at_tick(Shaft::Knots(STOPS), 6.1),
                    [on, Criterion::NoBreakAtRest],
                ),
            ]
        },
    },
    Case {
        id: "H50",
        name: "event-cap",
        title: "Twenty events in a step that may report eight",
        hard: "The rest waits for the next step, where as many wait again: no number of cycles can be right, and the \
               torque must stay within its limits all the same. A scene warns and gives no frequency.",
        source: "a stick of 4 µs and a slip of 0.6 µs in steps of 50 µs; the cap is EVENTS_PER_STEP",
        long: false,
        must: located,
        trials: |subject| {
            let settings = joint(subject.convention, [1e-9, 1e5, 0.0, 0.2, 0.4]);
            [1.0, -1.0]
                .map(|omega| {
                    let criteria = [Criterion::Survives, Criterion::EventsPerStep { most: 8 }];
                    trial(settings, at_tick(Shaft::Constant(omega), 0.05), criteria)
                })
                .to_vec()
        },
    },
    Case {
        id: "H51",
        name: "from-kinetic",
        title: "The other restart: a stick begins at Tk",
        hard: "The paper's prose, T between Tk and Ts: the torque never falls below Tk, and a stick winds half as far. \
               Only `frozen` has it, and nothing but the restart differs.",
        source: "closed form: a stick of (Ts − Tk)/(kr·Ω), a slip as eqs. (10)–(11)",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let mut settings = paper_joint(subject.convention);
            settings.restart = crepitus_model::Restart::FromKinetic;
            let p = settings.parameters;
            [0.1, 1.0, -1.0]
                .map(|omega: f64| {
                    let drop_nm = p.static_torque_nm - p.kinetic_torque_nm;
                    let stick_s = drop_nm / (p.stiffness_nm_per_rad * omega.abs());
                    let cycle_s = stick_s + super::tools::slip_s(&p, omega);
                    let (low_nm, high_nm) = if omega > 0.0 {
                        (0.2, 0.4)
                    } else {
                        (-0.4, -0.2)
                    };
                    let criteria = [
                        Criterion::CycleRate {
                            hz: 1.0 / cycle_s,
                            within: Limits {
                                f64: 1e-9,
                                f32: 1e-5,
                            },
                        },
                        Criterion::TorqueWithin {
                            from_s: 0.1,
                            low_nm,
                            high_nm,
                            slack_nm: 1e-6,
                        },
                    ];
                    trial(settings, at_tick(Shaft::Constant(omega), 2.0), criteria)
                })
                .to_vec()
        },
    },
];

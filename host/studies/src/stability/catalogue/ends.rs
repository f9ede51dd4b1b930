//! Motions that end with the run, a shaft that comes to rest where the object
//! rests, and a step with more events than it may report.

use super::motions::{DWELL, STOP, WANDER};
use super::tools::{CASE, FROZEN, LOCATED, MOVING, at_tick, constant, knots, slip_s};
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{
    BREAKS, EVENTS, count, cycle_rate, events, events_per_step, first_break_after, mirror_of,
    no_break_at_rest, survives, torque,
};
use crate::stability::criterion::Limits;
use crate::stability::input::Shaft;
use crepitus_model::{Convention, Parameters, Restart};
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
        trials: |_| {
            let ends = [knots(DWELL, 1.1), knots(STOP, 2.0), knots(WANDER, 1.05)];
            let mut trials: Vec<Trial> = ends.map(|input| input.meets([events(LOCATED)])).into();
            // 15/8 · 0.8 rad at 1.5 rad/s is one second a stroke.
            let strokes = |sign: f64| {
                let strokes = Strokes {
                    from_rad: 0.0,
                    to_rad: sign * 0.8,
                    peak_speed_rad_s: 1.5,
                    pause_s: 0.0,
                };
                at_tick(Shaft::Strokes(strokes), 2.0)
            };
            let rows = |sign| at_tick(Shaft::Rows(ROWS, sign, 2.0), 1.0);
            for (input, mirrored) in [(strokes(1.0), strokes(-1.0)), (rows(1.0), rows(-1.0))] {
                trials.push(input.meets([mirror_of(mirrored), count(BREAKS, 1, 100)]));
            }
            trials
        },
        ..CASE
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
        trials: |subject| {
            let at_s = match subject.convention {
                Convention::Paper => 6.035,
                _ => 6.027_5,
            };
            let few = count(EVENTS, 1, 2);
            let at_rest = torque(5.6, 0.2, 0.2, 1e-5);
            let on = first_break_after(5.6, at_s, 1e-4);
            let damped = [0.01, 400.0, 3.0, 0.2, 0.4];
            [
                knots(STOPS, 5.9).meets([few, at_rest, no_break_at_rest()]),
                knots(STOPS, 6.1).meets([on, no_break_at_rest()]),
            ]
            .map(|trial| trial.with(damped))
            .into()
        },
        ..MOVING
    },
    Case {
        id: "H50",
        name: "event-cap",
        title: "Twenty events in a step that may report eight",
        hard: "The rest waits for the next step, where as many wait again: no number of cycles can be right, and the \
               torque must stay within its limits all the same. A scene warns and gives no frequency.",
        source: "a stick of 4 µs and a slip of 0.6 µs in steps of 50 µs; the cap is EVENTS_PER_STEP",
        trials: |_| {
            [1.0, -1.0]
                .map(|omega| {
                    let trial = constant(omega, 0.05).meets([survives(), events_per_step(8)]);
                    trial.with([1e-9, 1e5, 0.0, 0.2, 0.4])
                })
                .into()
        },
        ..CASE
    },
    Case {
        id: "H51",
        name: "from-kinetic",
        title: "The other restart: a stick begins at Tk",
        hard: "The paper's prose, T between Tk and Ts: the torque never falls below Tk, and a stick winds half as far. \
               Only `frozen` has it, and nothing but the restart differs.",
        source: "closed form: a stick of (Ts − Tk)/(kr·Ω), a slip as eqs. (10)–(11)",
        trials: |_| {
            let p = Parameters::default();
            [0.1, 1.0, -1.0]
                .map(|omega: f64| {
                    let drop_nm = p.static_torque_nm - p.kinetic_torque_nm;
                    let stick_s = drop_nm / (p.stiffness_nm_per_rad * omega.abs());
                    let rate_hz = 1.0 / (stick_s + slip_s(&p, omega));
                    let rate = cycle_rate(rate_hz, Limits(1e-9, 1e-5));
                    let high_nm = if omega > 0.0 { 0.4 } else { -0.2 };
                    let band = torque(0.1, high_nm - 0.2, high_nm, 1e-6);
                    let mut trial = constant(omega, 2.0).meets([rate, band]);
                    trial.settings.restart = Restart::FromKinetic;
                    trial
                })
                .into()
        },
        ..FROZEN
    },
];

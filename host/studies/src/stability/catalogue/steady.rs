//! A shaft at constant speed or at rest, with closed forms.

use super::tools::{CASE, LOCATED, at_tick, constant, most_hz, sine};
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{
    BREAKS, EVENTS, REVERSES, events, events_per_second, events_per_step, exactly, mirror_of,
    torque, torque_stays,
};
use crate::stability::criterion::Limits;
use crate::stability::input::{Input, Shaft};
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;

/// Rest at 0.9·Ts/kr after a careful approach.
const APPROACH: &[(f64, f64, f64)] = &[
    (0.0, 0.0, 0.0),
    (0.05, 0.018, 0.018),
    (0.1, 0.0, 0.0),
    (0.2, 0.0, 0.0),
];

/// Rest from the start, and after an approach.
fn rest(duration_s: f64) -> Vec<Trial> {
    [Shaft::Constant(0.0), Shaft::Knots(APPROACH)]
        .map(|shaft| {
            // One step later the last acceleration is over, too.
            let criteria = [exactly(EVENTS, 0), torque_stays(0.101)];
            Input::sampled(shaft, duration_s, 1e-3).meets(criteria)
        })
        .into()
}

const REST: Case = Case {
    id: "H03",
    name: "rest",
    title: "A shaft at rest, slack and loaded to 0.9 Ts",
    hard: "A regularised friction law creeps under load; rounding errors accumulate; a comparison \
           of two zeros can start a slip.",
    source: "at rest nothing in eqs. (1) to (11) moves",
    trials: |_| rest(100.0),
    ..CASE
};

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H01",
        name: "constant-speed",
        title: "Constant speed from 0.05 to 3 rad/s",
        hard: "A stick lasts from 20 ms down to 0.33 ms, a slip ends where the velocities touch with an overlap of \
               λ²/2, 0.06 % at 3 rad/s, and each error shifts all events after it.",
        source: "tests/reference-cases, c01, c03z and c05, with 50 digits; closed form of the cycle, docs/model.md",
        trials: |_| {
            [
                (0.05, 10.0),
                (0.1, 10.0),
                (0.5, 4.0),
                (1.0, 2.0),
                (3.0, 2.0),
            ]
            .map(|(omega, duration_s)| {
                constant(omega, duration_s).meets([events(Limits(1e-12, 5e-6))])
            })
            .into()
        },
        ..CASE
    },
    Case {
        id: "H02",
        name: "mirror",
        title: "The other direction is the mirror image",
        hard: "The paper's equations hold for Ω > 0 only. A comparison with > on one side and ≥ on the other, or a \
               sum in another order, makes flexion and extension differ.",
        source: "the equations are odd in angle and torque; tests/reference-cases, n06, with 50 digits",
        trials: |_| {
            let swing = |amplitude_rad| at_tick(sine(amplitude_rad, 0.25), 4.0);
            vec![
                constant(-1.0, 1.0).meets([mirror_of(constant(1.0, 1.0))]),
                swing(-0.785).meets([mirror_of(swing(0.785))]),
            ]
        },
        ..CASE
    },
    REST,
    Case {
        id: "H03L",
        name: "rest-24h",
        title: "A shaft at rest for 24 hours",
        long: true,
        trials: |_| rest(86_400.0),
        ..REST
    },
    Case {
        id: "H08",
        name: "equal-torques",
        title: "Ts = Tk: breaks once and slides for ever",
        hard: "Once per period the velocities touch without crossing, with the torque exactly at the limit: a root \
               of even multiplicity, where rounding decides between no event and a stick of zero length.",
        source: "with Ts = Tk a slip takes nothing from the spring; tests/reference-cases, d13, with 50 digits",
        trials: |_| {
            let criteria = [
                exactly(EVENTS, 1),
                events_per_step(4),
                torque(0.01, 0.3, 0.3, 1e-7),
            ];
            let trial = constant(1.0, 2.0).meets(criteria);
            vec![trial.with([0.01, 400.0, 0.0, 0.3, 0.3])]
        },
        ..CASE
    },
    Case {
        id: "H09",
        name: "nearly-equal-torques",
        title: "Ts a millionth above Tk",
        hard: "A stick lasts 1.5 ns, a thirty-thousandth of a step, and in f32 a millionth is eight roundings: the \
               phases must not chatter between two samples.",
        source: "tests/reference-cases, d14, with 50 digits",
        trials: |_| {
            let values = [0.01, 400.0, 0.0, 0.3, 0.3 * (1.0 + 1e-6)];
            let rate = events_per_second(2.0 * most_hz(&Parameters::of(values)) + 2.0);
            let trial = constant(1.0, 2.0).meets([rate, events_per_step(4)]);
            vec![trial.with(values)]
        },
        ..CASE
    },
    Case {
        id: "H10",
        name: "no-kinetic-friction",
        title: "Tk = 0: every slip ends exactly at −Ts",
        hard: "The torque that stick needs after a slip is the static limit itself. Without a tolerance rounding \
               turns every stick into a reverse; one built without it counted 636 reverses.",
        source: "2Tk − Ts = −Ts; tests/reference-cases, z14, with 50 digits",
        trials: |_| {
            let criteria = [exactly(BREAKS, 64), exactly(REVERSES, 0), events(LOCATED)];
            let trial = constant(1.0, 2.0).meets(criteria);
            vec![trial.with([0.01, 400.0, 0.0, 0.0, 0.4])]
        },
        ..CASE
    },
];

//! The length of a step, and very many steps.

use super::tools::{CASE, TICK_S, cycle_hz, is_frozen, repeated};
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{cycle_rate, interval_variation, torque};
use crate::stability::criterion::{Criterion, Limits};
use crate::stability::input::{Input, Shaft};
use crate::stability::subject::Rung;
use crepitus_model::Parameters;
use crepitus_model::solver::Solver;
use crepitus_scene::scene::Precision;

/// The closed form's frequency for the paper's parameters.
fn rate(omega_rad_s: f64, within: impl Into<Limits>) -> Criterion {
    cycle_rate(cycle_hz(&Parameters::default(), omega_rad_s), within)
}

fn endurance(duration_s: f64) -> Trial {
    let criteria = [rate(1.0, 1e-5), torque(0.0, 0.0, 0.4, 1e-5)];
    repeated(1.0, duration_s, TICK_S).meets(criteria)
}

const ENDURANCE: Case = Case {
    id: "H23",
    name: "endurance",
    title: "100 seconds at the device's tick",
    hard: "Two million steps: a frequency error of 1e-5, a fortieth of a cent, can come from rounding of the slip's \
           duration alone, and any drift of the torque's band accumulates.",
    source: "closed form of the cycle; a tick of f32 keeps 1e-7 of its fraction",
    trials: |_| vec![endurance(100.0)],
    ..CASE
};

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H19",
        name: "step-length",
        title: "The frequency does not depend on the step",
        hard: "What a knee sounds like must not change with the sampling rate. Without location each event is up \
               to a step late, and the errors of break and match add up or cancel depending on the step.",
        source: "closed form of the cycle; within 5e-7 of it for rungs that locate both events, 5e-4 for the others",
        trials: |subject| {
            let locates = match subject.solver {
                Rung::Reference
                | Rung::Ladder(
                    Solver::ExactInterpolated | Solver::ExactEvents | Solver::Rk4Events,
                ) => true,
                Rung::Ladder(Solver::ExactBreak) => is_frozen(subject),
                Rung::Ladder(_) => false,
            };
            let within = if locates { 5e-7 } else { 5e-4 };
            [1e-3, 2e-4, 5e-5, 2e-5]
                .map(|step_s| {
                    let input = Input::sampled(Shaft::Constant(0.5), 4.0, step_s);
                    input.meets([rate(0.5, within)])
                })
                .into()
        },
        ..CASE
    },
    ENDURANCE,
    Case {
        id: "H23L",
        name: "endurance-24h",
        title: "24 hours at the device's tick in f32: 1.7 thousand million steps",
        long: true,
        of: |subject| subject.precision == Precision::F32,
        trials: |_| vec![endurance(86_400.0)],
        ..ENDURANCE
    },
    Case {
        id: "H24",
        name: "no-clock",
        title: "Events come on time after more than 1024 s",
        hard: "A clock t += h in f32 loses digits as it grows: with 50 µs it stops at 1024 s, with 1 ms its \
               last digit is an eighth of the step by then. There must be no such clock.",
        source: "at 1024 s half a step of an f32 is 61 µs, more than a tick",
        trials: |_| {
            let criteria = [
                rate(0.2, Limits(1e-9, 1e-5)),
                // That last digit would scatter the events by 1e-3 of a cycle.
                interval_variation(1e-4),
            ];
            vec![repeated(0.2, 1100.0, 1e-3).meets(criteria)]
        },
        ..CASE
    },
];

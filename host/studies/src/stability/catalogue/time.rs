//! The length of a step, and very many steps.

use super::tools::{TICK_S, cycle_hz, paper_joint, trial};
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::{Criterion, Limits};
use crate::stability::input::{Input, Shaft};
use crate::stability::subject::{Rung, Subject};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters};
use crepitus_scene::scene::Precision;

/// The closed form's frequency for the paper's parameters.
fn rate(omega_rad_s: f64, within: Limits) -> Criterion {
    Criterion::CycleRate {
        hz: cycle_hz(&Parameters::default(), omega_rad_s),
        within,
    }
}

fn a_day_trial(subject: Subject, duration_s: f64) -> Vec<Trial> {
    let input = Input::Repeated {
        omega_rad_s: 1.0,
        duration_s,
        step_s: TICK_S,
    };
    let criteria = [
        rate(1.0, Limits::both(1e-5)),
        Criterion::TorqueWithin {
            from_s: 0.0,
            low_nm: 0.0,
            high_nm: 0.4,
            slack_nm: 1e-5,
        },
    ];
    vec![trial(paper_joint(subject.convention), input, criteria)]
}

const A_DAY_SHORT: Case = Case {
    id: "H23",
    name: "endurance",
    title: "100 seconds at the device's tick",
    hard: "Two million steps: a frequency error of 1e-5, a fortieth of a cent, can come from rounding of the slip's \
           duration alone, and any drift of the torque's band accumulates.",
    source: "closed form of the cycle; a tick of f32 keeps 1e-7 of its fraction",
    long: false,
    must: located,
    trials: |subject| a_day_trial(subject, 100.0),
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
        long: false,
        must: located,
        trials: |subject| {
            let locates = match subject.solver {
                Rung::Reference
                | Rung::Ladder(
                    Solver::ExactInterpolated | Solver::ExactEvents | Solver::Rk4Events,
                ) => true,
                Rung::Ladder(Solver::ExactBreak) => subject.convention == Convention::Frozen,
                Rung::Ladder(_) => false,
            };
            let within = Limits::both(if locates { 5e-7 } else { 5e-4 });
            [1e-3, 2e-4, 5e-5, 2e-5]
                .map(|step_s| {
                    let input = Input::Sampled {
                        shaft: Shaft::Constant(0.5),
                        duration_s: 4.0,
                        step_s,
                    };
                    trial(paper_joint(subject.convention), input, [rate(0.5, within)])
                })
                .to_vec()
        },
    },
    A_DAY_SHORT,
    Case {
        id: "H23L",
        name: "endurance-24h",
        title: "24 hours at the device's tick in f32: 1.7 thousand million steps",
        long: true,
        trials: |subject| match subject.precision {
            Precision::F32 => a_day_trial(subject, 86_400.0),
            Precision::F64 => Vec::new(),
        },
        ..A_DAY_SHORT
    },
    Case {
        id: "H24",
        name: "no-clock",
        title: "Events come on time after more than 1024 s",
        hard: "A clock t += h in f32 loses digits as it grows: with 50 µs it stops at 1024 s, with 1 ms its \
               last digit is an eighth of the step by then. There must be no such clock.",
        source: "at 1024 s half a step of an f32 is 61 µs, more than a tick",
        long: false,
        must: located,
        trials: |subject| {
            let input = Input::Repeated {
                omega_rad_s: 0.2,
                duration_s: 1100.0,
                step_s: 1e-3,
            };
            let criteria = [
                rate(
                    0.2,
                    Limits {
                        f64: 1e-9,
                        f32: 1e-5,
                    },
                ),
                // That last digit would scatter the events by 1e-3 of a cycle.
                Criterion::IntervalVariation { most: 1e-4 },
            ];
            vec![trial(paper_joint(subject.convention), input, criteria)]
        },
    },
];

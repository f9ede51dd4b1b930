//! A damped object: just below, just above and far above critical damping.

use super::tools::{LOCATED, at_tick, events, exactly, joint, trial};
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::{Counted, Criterion};
use crate::stability::input::{Input, Shaft};
use crate::stability::subject::Subject;
use crepitus_model::Convention;
use crepitus_scene::scene::Precision;

/// One break, then the object comes to rest under the constant Tk.
fn strong_damping_trial(subject: Subject, duration_s: f64) -> Vec<Trial> {
    if subject.convention == Convention::Frozen {
        return Vec::new();
    }
    let settings = joint(subject.convention, [0.01, 400.0, 0.08, 0.2, 0.4]);
    let input = Input::Repeated {
        omega_rad_s: 1.0,
        duration_s,
        step_s: 1e-3,
    };
    let criteria = [
        exactly(Counted::Events, 1),
        Criterion::TorqueWithin {
            from_s: 0.01,
            low_nm: 0.2,
            high_nm: 0.2,
            slack_nm: 1e-7,
        },
    ];
    vec![trial(settings, input, criteria)]
}

const STRONG_DAMPING: Case = Case {
    id: "H12",
    name: "strong-damping",
    title: "Damping ratio 0.02: slides for ever after one break",
    hard: "The object's motion decays through all exponents into subnormal numbers. A method with negative \
           numerical damping rings instead, and sticks again.",
    source: "tests/reference-cases, e18, with 50 digits",
    long: false,
    must: located,
    trials: |subject| {
        let mut trials = strong_damping_trial(subject, 300.0);
        trials.extend(trials.first().cloned().map(|first| Trial {
            input: at_tick(Shaft::Constant(1.0), 10.0),
            criteria: vec![events(LOCATED)],
            ..first
        }));
        trials
    },
};

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H11",
        name: "near-critical-damping",
        title: "Damping just below and above the one at which stick-slip ceases",
        hard: "Below it the object still catches up with the shaft, above it no more: the velocities graze, and a \
               search for a change of sign finds neither. Numerical damping, −ωn·h/2 or +ωn·h/2 for the \
               Eulers, decides alone.",
        source: "one slip's energy balance, tests/reference-cases, m23, on both sides of it (1 ± 1e-6); \
                 1 ± 1e-3 for f32, whose own numbers are 6e-8 apart",
        long: false,
        must: located,
        trials: |subject| {
            // The critical c for Ω = 1 and 0.1 rad/s; under `paper` the break
            // torque excludes the damper, so its slips begin with more torque.
            let critical = match subject.convention {
                // The closed form has no damping.
                Convention::Frozen => return Vec::new(),
                Convention::Paper => [0.003_271_580_514_287_337, 0.281_634_388_770_458_2],
                Convention::Physical => [0.003_167_619_831_808_052, 0.231_316_464_550_656_4],
            };
            let off = match subject.precision {
                Precision::F64 => 1e-6,
                Precision::F32 => 1e-3,
            };
            let run = |omega: f64, c: f64, count: u64| {
                let settings = joint(subject.convention, [0.01, 400.0, c, 0.2, 0.4]);
                let input = at_tick(Shaft::Constant(omega), 1.0);
                trial(settings, input, [exactly(Counted::Events, count)])
            };
            let [fast, slow] = critical;
            vec![
                run(1.0, fast * (1.0 - off), 63),
                run(1.0, fast * (1.0 + off), 1),
                run(0.1, slow * (1.0 - off), 61),
                run(0.1, slow * (1.0 + off), 1),
            ]
        },
    },
    STRONG_DAMPING,
    Case {
        id: "H12L",
        name: "strong-damping-24h",
        title: "Sliding for 24 hours after one break",
        long: true,
        trials: |subject| strong_damping_trial(subject, 86_400.0),
        ..STRONG_DAMPING
    },
];

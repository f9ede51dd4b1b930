//! A damped object: just below, just above and far above critical damping.

use super::tools::{LOCATED, MOVING, constant, repeated};
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{EVENTS, events, exactly, torque};
use crepitus_model::Convention;
use crepitus_scene::scene::Precision;

/// J, kr, c, Tk and Ts with a damping ratio of 0.02.
const STRONGLY_DAMPED: [f64; 5] = [0.01, 400.0, 0.08, 0.2, 0.4];

/// One break, then the object comes to rest under the constant Tk.
fn strong_damping(duration_s: f64) -> Trial {
    repeated(1.0, duration_s, 1e-3)
        .meets([exactly(EVENTS, 1), torque(0.01, 0.2, 0.2, 1e-7)])
        .with(STRONGLY_DAMPED)
}

const STRONG_DAMPING: Case = Case {
    id: "H12",
    name: "strong-damping",
    title: "Damping ratio 0.02: slides for ever after one break",
    hard: "The object's motion decays through all exponents into subnormal numbers. A method with negative \
           numerical damping rings instead, and sticks again.",
    source: "tests/reference-cases, e18, with 50 digits",
    trials: |_| {
        let sampled = constant(1.0, 10.0).meets([events(LOCATED)]);
        vec![strong_damping(300.0), sampled.with(STRONGLY_DAMPED)]
    },
    ..MOVING
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
        trials: |subject| {
            // The critical c for Ω = 1 and 0.1 rad/s; under `paper` the break
            // torque excludes the damper, so its slips begin with more torque.
            let [fast, slow] = match subject.convention {
                Convention::Paper => [0.003_271_580_514_287_337, 0.281_634_388_770_458_2],
                _ => [0.003_167_619_831_808_052, 0.231_316_464_550_656_4],
            };
            let off = match subject.precision {
                Precision::F64 => 1e-6,
                Precision::F32 => 1e-3,
            };
            let run = |omega, c, count| {
                let trial = constant(omega, 1.0).meets([exactly(EVENTS, count)]);
                trial.with([0.01, 400.0, c, 0.2, 0.4])
            };
            vec![
                run(1.0, fast * (1.0 - off), 63),
                run(1.0, fast * (1.0 + off), 1),
                run(0.1, slow * (1.0 - off), 61),
                run(0.1, slow * (1.0 + off), 1),
            ]
        },
        ..MOVING
    },
    STRONG_DAMPING,
    Case {
        id: "H12L",
        name: "strong-damping-24h",
        title: "Sliding for 24 hours after one break",
        long: true,
        trials: |_| vec![strong_damping(86_400.0)],
        ..STRONG_DAMPING
    },
];

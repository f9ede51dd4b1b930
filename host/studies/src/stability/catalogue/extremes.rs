//! Parameters and speeds at the ends of their ranges.

use super::tools::{CASE, LOCATED, TICK_S, constant, cycle_hz, is_frozen, slip_s};
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{
    BREAKS, count, cycle_rate, events, events_per_step, slip_time, survives, torque,
};
use crate::stability::criterion::Limits;
use crate::stability::input::{Input, What};
use crepitus_model::parameters::Tabled;
use crepitus_model::{Parameters, Real};

fn storm(seed: u64, duration_s: f64) -> Trial {
    let most_rad_s = 50.0;
    let input = Input::new(What::White { most_rad_s, seed }, duration_s, TICK_S);
    input.meets([survives(), events_per_step(8)])
}

const STORM: Case = Case {
    id: "H32",
    name: "storm",
    title: "White velocity of ±50 rad/s",
    hard: "A broken sensor looks like this. Accelerations of 2e6 rad/s² and jumps at every fourth step lead \
           through every branch; the work of a step must stay bounded, and everything finite.",
    source: "what holds for any motion: |T| ≤ Ts, at most 8 events a step, no NaN",
    trials: |_| vec![storm(1, 5.0), storm(2, 5.0)],
    ..CASE
};

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H13",
        name: "stiff",
        title: "ωn·h = 3.16: two steps a cycle",
        hard: "The object swings faster than the step. Explicit methods blow up above ωn·h = 2, implicit Euler \
               damps the swing away, and a method without location finds one cycle in twenty.",
        source: "tests/reference-cases, k15, with 50 digits",
        trials: |_| {
            let values = [1e-5, 4e4, 0.0, 0.2, 0.4];
            let duration_s = 0.1;
            let cycles = cycle_hz(&Parameters::of(values), 1.0) * duration_s;
            let breaks = count(BREAKS, (cycles * 0.99).whole(), (cycles * 1.01).whole());
            vec![constant(1.0, duration_s).meets([breaks]).with(values)]
        },
        ..CASE
    },
    Case {
        id: "H14",
        name: "light",
        title: "Hardly any inertia: J = 1e-9 and 1e-12 kg·m²",
        hard: "A slip lasts 160 ns to 5 µs, far less than a step, and 1/J is 1e12: in the limit the angle jumps. \
               Accelerations of 2e11 rad/s² must not overflow, nor their squares.",
        source: "J → 0: a slip takes no time and ends at 2Tk − Ts; tests/reference-cases, j21, with 50 digits",
        trials: |_| {
            [1e-9, 1e-12]
                .map(|inertia| {
                    let values = [inertia, 400.0, 0.0, 0.2, 0.4];
                    let hz = cycle_hz(&Parameters::of(values), 1.0);
                    let rate = cycle_rate(hz, Limits(1e-9, 1e-5));
                    let trial = constant(1.0, 0.5).meets([rate, torque(0.0, 0.0, 0.4, 1e-5)]);
                    trial.with(values)
                })
                .into()
        },
        ..CASE
    },
    Case {
        id: "H15",
        name: "soft-and-strong",
        title: "A soft spring, a very soft one, and a million newton metres",
        hard: "A stick winds up by 400 or 2500 rad in steps of 1 mrad: in f32 a plain sum stops growing once the \
               step is half its last digit, and the break comes late or never.",
        source: "tests/reference-cases, l16, with 50 digits; closed form of the cycle",
        trials: |_| {
            // The only error is the rounding of a sum of 4e5 steps.
            let summed = Limits(1e-9, LOCATED.1);
            let run = |values, omega, duration_s, within_s: Limits| {
                let trial = constant(omega, duration_s).meets([events(within_s)]);
                trial.with(values)
            };
            vec![
                run([0.01, 10.0, 0.0, 0.2, 0.4], 1.0, 10.0, LOCATED),
                run([0.01, 1e-3, 0.0, 0.2, 0.4], 20.0, 21.0, summed),
                run([0.01, 400.0, 0.0, 0.2, 1e6], 200.0, 13.0, summed),
            ]
        },
        ..CASE
    },
    STORM,
    Case {
        id: "H32L",
        name: "storm-long",
        title: "White velocity for ten million steps",
        long: true,
        trials: |_| vec![storm(3, 500.0)],
        ..STORM
    },
    Case {
        id: "H33",
        name: "high-speed",
        title: "Up to a million radians per second",
        hard: "A stick lasts a nanosecond, and v² + ωn²x² is 1e12. Under paper and physical the velocities overlap \
               by λ²/2 = 5e-15 of the speed, which no number of f32 and few of f64 can hold: there only the \
               common bounds must hold. A frozen slip must last the whole period 2π/ωn.",
        source: "what holds for any motion: |T| ≤ Ts; a slip of any speed lasts less than 2π/ωn",
        trials: |subject| {
            [1e3, 1e6, -1e6]
                .map(|omega| {
                    let mut criteria = vec![survives()];
                    if is_frozen(subject) {
                        let lasting_s = slip_s(&Parameters::default(), omega);
                        criteria.push(slip_time(lasting_s, Limits(1e-9, 1e-6)));
                    }
                    constant(omega, 1.0).meets(criteria)
                })
                .into()
        },
        ..CASE
    },
];

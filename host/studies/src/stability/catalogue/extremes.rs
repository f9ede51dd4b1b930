//! Parameters and speeds at the ends of their ranges.

use super::tools::{LOCATED, TICK_S, at_tick, cycle_hz, events, joint, paper_joint, slip_s, trial};
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::{Input, Shaft};
use crate::stability::subject::Subject;
use crepitus_model::{Convention, Real};

fn storm_trials(
    subject: Subject,
    seeds: std::ops::RangeInclusive<u64>,
    duration_s: f64,
) -> Vec<Trial> {
    seeds
        .map(|seed| {
            let input = Input::White {
                most_rad_s: 50.0,
                seed,
                duration_s,
                step_s: TICK_S,
            };
            let criteria = [Criterion::Survives, Criterion::EventsPerStep { most: 8 }];
            trial(paper_joint(subject.convention), input, criteria)
        })
        .collect()
}

const STORM: Case = Case {
    id: "H32",
    name: "storm",
    title: "White velocity of ±50 rad/s",
    hard: "A broken sensor looks like this. Accelerations of 2e6 rad/s² and jumps at every fourth step lead \
           through every branch; the work of a step must stay bounded, and everything finite.",
    source: "what holds for any motion: |T| ≤ Ts, at most 8 events a step, no NaN",
    long: false,
    must: located,
    trials: |subject| storm_trials(subject, 1..=2, 5.0),
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
        long: false,
        must: located,
        trials: |subject| {
            let settings = joint(subject.convention, [1e-5, 4e4, 0.0, 0.2, 0.4]);
            let duration_s = 0.1;
            let cycles = cycle_hz(&settings.parameters, 1.0) * duration_s;
            let count = |share: f64| (cycles * share).whole();
            let breaks = Criterion::Count {
                what: Counted::Breaks,
                least: count(0.99),
                most: count(1.01),
            };
            vec![trial(
                settings,
                at_tick(Shaft::Constant(1.0), duration_s),
                [breaks],
            )]
        },
    },
    Case {
        id: "H14",
        name: "light",
        title: "Hardly any inertia: J = 1e-9 and 1e-12 kg·m²",
        hard: "A slip lasts 160 ns to 5 µs, far less than a step, and 1/J is 1e12: in the limit the angle jumps. \
               Accelerations of 2e11 rad/s² must not overflow, nor their squares.",
        source: "J → 0: a slip takes no time and ends at 2Tk − Ts; tests/reference-cases, j21, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            [1e-9, 1e-12]
                .map(|inertia| {
                    let settings = joint(subject.convention, [inertia, 400.0, 0.0, 0.2, 0.4]);
                    let criteria = [
                        Criterion::CycleRate {
                            hz: cycle_hz(&settings.parameters, 1.0),
                            within: Limits {
                                f64: 1e-9,
                                f32: 1e-5,
                            },
                        },
                        Criterion::TorqueWithin {
                            from_s: 0.0,
                            low_nm: 0.0,
                            high_nm: 0.4,
                            slack_nm: 1e-5,
                        },
                    ];
                    trial(settings, at_tick(Shaft::Constant(1.0), 0.5), criteria)
                })
                .to_vec()
        },
    },
    Case {
        id: "H15",
        name: "soft-and-strong",
        title: "A soft spring, a very soft one, and a million newton metres",
        hard: "A stick winds up by 400 or 2500 rad in steps of 1 mrad: in f32 a plain sum stops growing once the \
               step is half its last digit, and the break comes late or never.",
        source: "tests/reference-cases, l16, with 50 digits; closed form of the cycle",
        long: false,
        must: located,
        trials: |subject| {
            let on = |values, omega, duration_s, within_s| {
                let input = at_tick(Shaft::Constant(omega), duration_s);
                trial(joint(subject.convention, values), input, [events(within_s)])
            };
            // The only error is the rounding of a sum of 4e5 steps.
            let summed = Limits {
                f64: 1e-9,
                f32: LOCATED.f32,
            };
            vec![
                on([0.01, 10.0, 0.0, 0.2, 0.4], 1.0, 10.0, LOCATED),
                on([0.01, 1e-3, 0.0, 0.2, 0.4], 20.0, 21.0, summed),
                on([0.01, 400.0, 0.0, 0.2, 1e6], 200.0, 13.0, summed),
            ]
        },
    },
    STORM,
    Case {
        id: "H32L",
        name: "storm-long",
        title: "White velocity for ten million steps",
        long: true,
        trials: |subject| storm_trials(subject, 3..=3, 500.0),
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
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            [1e3, 1e6, -1e6]
                .map(|omega: f64| {
                    let mut run = trial(
                        settings,
                        at_tick(Shaft::Constant(omega), 1.0),
                        [Criterion::Survives],
                    );
                    if subject.convention == Convention::Frozen {
                        run.criteria.push(Criterion::SlipTime {
                            slip_s: slip_s(&settings.parameters, omega),
                            within: Limits {
                                f64: 1e-9,
                                f32: 1e-6,
                            },
                        });
                    }
                    run
                })
                .to_vec()
        },
    },
];

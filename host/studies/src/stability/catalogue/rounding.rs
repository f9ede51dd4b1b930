//! Cases decided by the last digits.

use super::tools::{LOCATED, TICK_S, at_tick, events, exactly, joint, paper_joint, slip_s, trial};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::{Input, Shaft};
use crate::stability::subject::{Rung, Subject};
use crepitus_model::parameters::Tabled;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters};
use crepitus_scene::preset::joints;
use crepitus_scene::scene::Precision;

/// Subjects that check for a match only at the end of a step, after a break
/// located within it.
fn interpolates(subject: Subject) -> bool {
    subject.solver == Rung::Ladder(Solver::ExactInterpolated)
        && subject.convention != Convention::Frozen
}

// A stick of `paper` that is held at its limit while the hand brakes, and
// breaks in the instant in which the true torque reaches Tk.
const HELD: &[(f64, f64, f64)] = &[
    (0.0, 5.015_864_687_484_201, 5.015_864_687_484_201),
    (6e-4, -7.562_768_377_573_861, -7.562_768_377_573_861),
    (1.2e-3, 0.047_103_171_072_371_33, 0.047_103_171_072_371_33),
    (1.8e-3, 7.216_582_485_415_388, 7.216_582_485_415_388),
    (2.4e-3, 0.0, 0.0),
    (3e-3, -1.468_880_445_545_090_1, -1.468_880_445_545_090_1),
    (3.6e-3, 0.0, 0.0),
    (4.2e-3, -2.843_622_718_732_403_2, -2.843_622_718_732_403_2),
    (4.8e-3, 5.047_445_017_779_298, 5.047_445_017_779_298),
];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H52",
        name: "free-period",
        title: "The free period keeps its fraction of a tick in f32",
        hard: "A period of 628.3 ticks in one f32 number is known to 3e-5 of a tick, and every slip is off by it in \
               the same direction. In whole ticks and a fraction it is known to 6e-8.",
        source: "model/src/joint/ticks.rs; at 1000 rad/s a slip is a period but for λ = 1e-4",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            joints()
                .iter()
                .map(|preset| {
                    let p = preset.parameters;
                    let slip = Criterion::SlipTime {
                        slip_s: slip_s(&p, 1e3),
                        within: Limits {
                            f64: 1e-9,
                            f32: 2e-9,
                        },
                    };
                    let settings = joint(subject.convention, p.values());
                    trial(settings, at_tick(Shaft::Constant(1e3), 1.0), [slip])
                })
                .collect()
        },
    },
    Case {
        id: "H53",
        name: "subnormal-decay",
        title: "A decay ends at zero and not among the subnormal numbers",
        hard: "A damped object that slides for ever swings less and less. Its velocity passes through every exponent, \
               and some processors are a hundred times slower with subnormal numbers.",
        source: "damping ratio 0.5: e^(−100 t) is 1e-38 after 0.9 s and 1e-308 after 7 s; Real::AT_REST",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention == Convention::Frozen {
                return Vec::new();
            }
            let input = Input::Repeated {
                omega_rad_s: 1.0,
                duration_s: 20.0,
                step_s: 1e-3,
            };
            let settings = joint(subject.convention, [0.01, 400.0, 2.0, 0.2, 0.4]);
            vec![trial(settings, input, [Criterion::Subnormals { most: 0 }])]
        },
    },
    Case {
        id: "H54",
        name: "break-at-a-sample",
        title: "A break a rounding before the sample",
        hard: "The rest of the step is shorter than a rounding of the velocities: object and shaft are still equal, \
               and a method that checks only its end finds no lead, takes that for a match, and sticks at once.",
        source: "Ts/(kr·Ω) a whole number of steps, and a few roundings less",
        long: false,
        must: interpolates,
        trials: |subject| {
            if !interpolates(subject) {
                return Vec::new();
            }
            let settings = paper_joint(subject.convention);
            let p: Parameters = settings.parameters;
            let mut trials = Vec::new();
            for steps in [7_u32, 11, 13, 17, 20, 23, 37] {
                for roundings in [0_u32, 1, 2, 4, 8, 16] {
                    let share = 1.0 + f64::from(roundings) * 1.2e-7;
                    let stick_s = f64::from(steps) * TICK_S;
                    let omega = share * p.static_torque_nm / (p.stiffness_nm_per_rad * stick_s);
                    // The break and nothing else before the object turns.
                    let input = at_tick(Shaft::Constant(omega), stick_s + 0.01);
                    trials.push(trial(settings, input, [exactly(Counted::Events, 1)]));
                }
            }
            trials
        },
    },
    Case {
        id: "H55",
        name: "slip-without-lead",
        title: "A slip begins with equal velocities and equal accelerations",
        hard: "The velocities touch where the slip begins, and part with the third derivative only. To take a touch \
               for a match ends the slip where it began; to wait until they part by too wide a bound misses \
               the match that soon follows.",
        source: "found by a random search, kept in model/tests/invariances.rs; events by the reference",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Paper || subject.precision != Precision::F64 {
                return Vec::new();
            }
            let values = [
                0.000_547_687_392_378_403_7,
                1_835.059_038_387_849_8,
                0.0,
                0.012_793_380_822_306_502,
                0.033_641_039_952_803_445,
            ];
            [1e-5, 5e-5, 1e-4]
                .map(|step_s| {
                    let input = Input::Sampled {
                        shaft: Shaft::Knots(HELD),
                        duration_s: 4.8e-3,
                        step_s,
                    };
                    trial(joint(subject.convention, values), input, [events(LOCATED)])
                })
                .to_vec()
        },
    },
];

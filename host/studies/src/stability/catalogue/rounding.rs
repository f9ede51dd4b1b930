//! Cases decided by the last digits.

use super::tools::{CASE, FROZEN, LOCATED, MOVING, TICK_S, constant, is_frozen, repeated, slip_s};
use crate::stability::case::Case;
use crate::stability::criteria::{EVENTS, events, exactly, slip_time, subnormals};
use crate::stability::criterion::Limits;
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
    subject.solver == Rung::Ladder(Solver::ExactInterpolated) && !is_frozen(subject)
}

// A stick of `paper` that is held at its limit while the hand brakes, and
// breaks in the instant in which the true torque reaches Tk.
const HELD: Shaft = Shaft::Knots(&[
    (0.0, 5.015_864_687_484_201, 5.015_864_687_484_201),
    (6e-4, -7.562_768_377_573_861, -7.562_768_377_573_861),
    (1.2e-3, 0.047_103_171_072_371_33, 0.047_103_171_072_371_33),
    (1.8e-3, 7.216_582_485_415_388, 7.216_582_485_415_388),
    (2.4e-3, 0.0, 0.0),
    (3e-3, -1.468_880_445_545_090_1, -1.468_880_445_545_090_1),
    (3.6e-3, 0.0, 0.0),
    (4.2e-3, -2.843_622_718_732_403_2, -2.843_622_718_732_403_2),
    (4.8e-3, 5.047_445_017_779_298, 5.047_445_017_779_298),
]);

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H52",
        name: "free-period",
        title: "The free period keeps its fraction of a tick in f32",
        hard: "A period of 628.3 ticks in one f32 number is known to 3e-5 of a tick, and every slip is off by it in \
               the same direction. In whole ticks and a fraction it is known to 6e-8.",
        source: "model/src/joint/ticks.rs; at 1000 rad/s a slip is a period but for λ = 1e-4",
        trials: |_| {
            joints()
                .iter()
                .map(|joint| {
                    let slip = slip_time(slip_s(&joint.parameters, 1e3), Limits(1e-9, 2e-9));
                    let trial = constant(1e3, 1.0).meets([slip]);
                    trial.with(joint.parameters.values())
                })
                .collect()
        },
        ..FROZEN
    },
    Case {
        id: "H53",
        name: "subnormal-decay",
        title: "A decay ends at zero and not among the subnormal numbers",
        hard: "A damped object that slides for ever swings less and less. Its velocity passes through every exponent, \
               and some processors are a hundred times slower with subnormal numbers.",
        source: "damping ratio 0.5: e^(−100 t) is 1e-38 after 0.9 s and 1e-308 after 7 s; Real::AT_REST",
        trials: |_| {
            let trial = repeated(1.0, 20.0, 1e-3).meets([subnormals(0)]);
            vec![trial.with([0.01, 400.0, 2.0, 0.2, 0.4])]
        },
        ..MOVING
    },
    Case {
        id: "H54",
        name: "break-at-a-sample",
        title: "A break a rounding before the sample",
        hard: "The rest of the step is shorter than a rounding of the velocities: object and shaft are still equal, \
               and a method that checks only its end finds no lead, takes that for a match, and sticks at once.",
        source: "Ts/(kr·Ω) a whole number of steps, and a few roundings less",
        of: interpolates,
        must: interpolates,
        trials: |_| {
            let p = Parameters::default();
            let mut trials = Vec::new();
            for steps in [7.0, 11.0, 13.0, 17.0, 20.0, 23.0, 37.0] {
                for roundings in [0.0, 1.0, 2.0, 4.0, 8.0, 16.0] {
                    let share = 1.0 + roundings * 1.2e-7;
                    let stick_s = steps * TICK_S;
                    let omega = share * p.static_torque_nm / (p.stiffness_nm_per_rad * stick_s);
                    // The break and nothing else before the object turns.
                    let input = constant(omega, stick_s + 0.01);
                    trials.push(input.meets([exactly(EVENTS, 1)]));
                }
            }
            trials
        },
        ..CASE
    },
    Case {
        id: "H55",
        name: "slip-without-lead",
        title: "A slip begins with equal velocities and equal accelerations",
        hard: "The velocities touch where the slip begins, and part with the third derivative only. To take a touch \
               for a match ends the slip where it began; to wait until they part by too wide a bound misses \
               the match that soon follows.",
        source: "found by a random search, kept in model/tests/invariances.rs; events by the reference",
        of: |subject| {
            subject.convention == Convention::Paper && subject.precision == Precision::F64
        },
        trials: |_| {
            let values = [
                0.000_547_687_392_378_403_7,
                1_835.059_038_387_849_8,
                0.0,
                0.012_793_380_822_306_502,
                0.033_641_039_952_803_445,
            ];
            [1e-5, 5e-5, 1e-4]
                .map(|step_s| {
                    let input = Input::sampled(HELD, 4.8e-3, step_s);
                    input.meets([events(LOCATED)]).with(values)
                })
                .into()
        },
        ..CASE
    },
];

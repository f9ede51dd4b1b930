//! Independence from when a motion begins and from how it is cut into steps.

#![allow(clippy::cast_precision_loss, reason = "small numbers")]

mod support;

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, Parameters, Real, Settings, ShaftStep, StickSlip, Validated};
use proptest::prelude::*;

/// The shortest step; all others are multiples of it.
const UNIT_S: f64 = 1e-5;

/// Units between two knots of a motion.
const UNITS_PER_KNOT: usize = 60;

/// An event as it is compared: when, from and to which phase.
type Compared = (f64, i8, i8);

/// A shaft whose velocity is linear between knots, cut into steps of so many
/// units; knots are 60 units apart and never jump.
fn cut(knots_rad_s: &[f64], units: usize) -> Vec<ShaftStep<f64>> {
    let omega = |unit: usize| {
        let (i, part) = (unit / UNITS_PER_KNOT, (unit % UNITS_PER_KNOT) as f64);
        let (a, b) = (
            knots_rad_s[i],
            *knots_rad_s.get(i + 1).unwrap_or(&knots_rad_s[i]),
        );
        a + (b - a) * part / UNITS_PER_KNOT as f64
    };
    let total = (knots_rad_s.len() - 1) * UNITS_PER_KNOT;
    (0..total / units)
        .map(|n| {
            let (a, b) = (omega(n * units), omega((n + 1) * units));
            ShaftStep {
                delta_phi_rad: f64::midpoint(a, b) * units as f64 * UNIT_S,
                omega_start_rad_s: a,
                omega_end_rad_s: b,
            }
        })
        .collect()
}

struct Run<'a> {
    steps: &'a [ShaftStep<f64>],
    step_s: f64,
    rest: usize,
}

impl<F: Real> JointVisitor<F> for Run<'_> {
    /// The events, and the torque's bits after every step of the motion.
    type Output = (Vec<Compared>, Vec<u64>);

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Self::Output {
        for _ in 0..self.rest {
            joint.step(&ShaftStep::default(), |_| panic!("an event at rest"));
        }
        let (mut events, mut torques) = (Vec::new(), Vec::new());
        for (n, step) in self.steps.iter().enumerate() {
            let step = ShaftStep {
                delta_phi_rad: F::from_f64(step.delta_phi_rad),
                omega_start_rad_s: F::from_f64(step.omega_start_rad_s),
                omega_end_rad_s: F::from_f64(step.omega_end_rad_s),
            };
            joint.step(&step, |e| {
                let time_s = (n as f64 + e.fraction.to_f64()) * self.step_s;
                events.push((time_s, e.from.sign(), e.to.sign()));
            });
            torques.push(joint.torque_nm().to_f64().to_bits());
        }
        (events, torques)
    }
}

fn run<F: Real>(
    settings: &Validated<Settings>,
    solver: Solver,
    knots: &[f64],
    units: usize,
    rest: usize,
) -> (Vec<Compared>, Vec<u64>) {
    let (steps, step_s) = (cut(knots, units), units as f64 * UNIT_S);
    let omega = F::from_f64(knots[0]);
    let run = Run {
        steps: &steps,
        step_s,
        rest,
    };
    with_joint::<F, _>(settings, solver, step_s, omega, run).unwrap()
}

fn settings() -> impl Strategy<Value = Validated<Settings>> {
    (
        -3.5..-1.0_f64,
        1.5..3.5_f64,
        0.0..0.95_f64,
        -1.5..0.5_f64,
        0..3_usize,
    )
        .prop_map(|(j, kr, ratio, ts, convention)| {
            let static_torque_nm = 10_f64.powf(ts);
            Settings {
                parameters: Parameters {
                    inertia_kg_m2: 10_f64.powf(j),
                    stiffness_nm_per_rad: 10_f64.powf(kr),
                    damping_nms_per_rad: 0.0,
                    kinetic_torque_nm: ratio * static_torque_nm,
                    static_torque_nm,
                },
                convention: Convention::ALL[convention],
                ..Settings::default()
            }
            .validate()
            .unwrap()
        })
}

proptest! {
    #![proptest_config(support::cases(300))]

    #[test]
    fn it_does_not_matter_when_a_motion_begins(
        settings in settings(),
        rest in 1..500_usize,
        mut knots in prop::collection::vec(-8.0..8.0_f64, 3..40),
    ) {
        knots[0] = 0.0;
        for solver in Solver::ALL {
            if solver.refusal_in::<f32>(settings.convention).is_none() {
                let (at_once, later) = (
                    run::<f32>(&settings, solver, &knots, 5, 0),
                    run::<f32>(&settings, solver, &knots, 5, rest),
                );
                prop_assert_eq!(at_once, later, "{:?}", solver);
            }
        }
    }

    #[test]
    fn it_does_not_matter_how_a_motion_is_cut_into_steps(
        settings in settings(),
        knots in prop::collection::vec(-8.0..8.0_f64, 3..60),
    ) {
        let end_s = (knots.len() - 1) as f64 * UNITS_PER_KNOT as f64 * UNIT_S;
        let events = |units| {
            let mut events = run::<f64>(&settings, Solver::ExactEvents, &knots, units, 0).0;
            // Rounding decides whether an event at the very end is still seen.
            events.retain(|e| e.0 < end_s - 1e-10);
            events
        };
        let whole = events(20);
        // Half steps, quarters, twentieths, and three of a length that has
        // nothing to do with it.
        for units in [10, 5, 1, 15, 12, 3] {
            let other = events(units);
            prop_assert_eq!(whole.len(), other.len(), "{} units", units);
            for (a, b) in whole.iter().zip(&other) {
                prop_assert_eq!((a.1, a.2), (b.1, b.2));
                prop_assert!((a.0 - b.0).abs() < 1e-10, "{} units: {:?} {:?}", units, a, b);
            }
        }
    }
}

/// J, kr, Tk, Ts.
fn found(convention: Convention, [j, kr, tk, ts]: [f64; 4]) -> Validated<Settings> {
    Settings {
        parameters: Parameters {
            inertia_kg_m2: j,
            stiffness_nm_per_rad: kr,
            damping_nms_per_rad: 0.0,
            kinetic_torque_nm: tk,
            static_torque_nm: ts,
        },
        convention,
        ..Settings::default()
    }
    .validate()
    .unwrap()
}

#[test]
fn what_random_motions_have_found_stays_found() {
    // A stick held at its limit by hard braking, which breaks the other way
    // within the same step.
    let held = (
        found(
            Convention::Paper,
            [0.1, 1_060.322_033_439_598, 0.0, 0.074_636_858_272_875_01],
        ),
        vec![4.703_119_172_053_8, 0.0, -7.492_559_924_997_178],
    );
    // A match where the shaft's velocity is the small difference of two large
    // ones.
    let through_zero = (
        found(
            Convention::Physical,
            [
                0.003_883_513_421_084_801,
                60.997_453_511_421_76,
                0.070_854_902_279_200_37,
                0.217_763_090_958_308_8,
            ],
        ),
        vec![
            0.373_179_878_013_262_36,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            3.746_893_506_263_741,
            -0.944_878_336_790_270_6,
            5.408_821_061_100_674,
            -5.853_509_795_356_688,
            0.0,
            -1.830_416_136_617_120_5,
            1.932_740_425_778_591_6,
            4.882_613_517_377_967,
            -7.719_953_526_006_988_5,
            -1.274_678_022_165_786,
            6.640_296_805_153_033,
            -7.390_989_281_886_267,
        ],
    );
    // A match soon after a slip that began without relative acceleration.
    let touch = (
        found(
            Convention::Paper,
            [
                0.000_547_687_392_378_403_7,
                1_835.059_038_387_849_8,
                0.012_793_380_822_306_502,
                0.033_641_039_952_803_445,
            ],
        ),
        vec![
            5.015_864_687_484_201,
            -7.562_768_377_573_861,
            0.047_103_171_072_371_33,
            7.216_582_485_415_388,
            0.0,
            -1.468_880_445_545_090_1,
            0.0,
            -2.843_622_718_732_403_2,
            5.047_445_017_779_298,
        ],
    );
    for (settings, knots) in [held, through_zero, touch] {
        let events = |units| run::<f64>(&settings, Solver::ExactEvents, &knots, units, 0).0;
        let fine = events(1);
        assert!(!fine.is_empty());
        for units in [60, 20, 15, 10, 5] {
            let coarse = events(units);
            assert_eq!(coarse.len(), fine.len(), "{units} units");
            for (a, b) in coarse.iter().zip(&fine) {
                assert_eq!((a.1, a.2), (b.1, b.2), "{units} units");
                assert!((a.0 - b.0).abs() < 1e-10, "{units} units: {a:?} {b:?}");
            }
        }
    }
}

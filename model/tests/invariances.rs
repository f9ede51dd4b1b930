//! What must not matter: when a motion begins, and how it is cut into steps.
//! And what must never happen, however long one waits.

#![allow(clippy::cast_precision_loss, reason = "small numbers")]

mod support;

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, EVENTS_PER_STEP, Parameters, Phase, Real, Settings, ShaftStep, StickSlip, Validated,
};
use proptest::prelude::*;

/// The shortest step; all others are multiples of it.
const UNIT_S: f64 = 1e-5;

/// Units between two knots of a motion.
const UNITS_PER_KNOT: usize = 60;

/// An event as it is compared: when, from and to which phase.
type Seen = (f64, i8, i8);

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
    type Output = (Vec<Seen>, Vec<u64>);

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
) -> (Vec<Seen>, Vec<u64>) {
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
            if solver.refusal(settings.convention).is_none() {
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

/// Ten million steps of a shaft that jumps anywhere within ±50 rad/s.
struct White {
    steps: u32,
    limit_nm: f64,
}

impl<F: Real> JointVisitor<F> for White {
    type Output = u64;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> u64 {
        let (mut seed, mut omega, mut all) = (1_u64, F::ZERO, 0);
        let limit = F::from_f64(self.limit_nm);
        for _ in 0..self.steps {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            let next = F::from_f64((seed >> 11) as f64 / (1_u64 << 53) as f64 * 100.0 - 50.0);
            let step = ShaftStep {
                delta_phi_rad: F::HALF * (omega + next) * F::from_f64(5e-5),
                omega_start_rad_s: omega,
                omega_end_rad_s: next,
            };
            // One step in four begins with a jump.
            omega = if seed.is_multiple_of(4) { -next } else { next };
            let mut events = 0;
            joint.step(&step, |_| events += 1);
            assert!(events <= EVENTS_PER_STEP);
            all += events as u64;
            assert!(joint.torque_nm().abs() <= limit);
            assert!(matches!(joint.phase(), Phase::Slip(_)) || joint.theta_rad().is_finite());
        }
        assert!(joint.theta_rad().is_finite() && joint.theta_dot_rad_s().is_finite());
        all
    }
}

#[test]
fn ten_million_random_steps_are_finite_and_bounded() {
    for convention in Convention::ALL {
        let settings = Settings {
            convention,
            ..Settings::default()
        };
        let valid = settings.validate().unwrap();
        let white = || White {
            steps: 10_000_000 / 6,
            limit_nm: settings.parameters.static_torque_nm,
        };
        let single = with_joint::<f32, _>(&valid, Solver::ExactEvents, 5e-5, 0.0, white());
        let double = with_joint::<f64, _>(&valid, Solver::ExactEvents, 5e-5, 0.0, white());
        let (single, double) = (single.unwrap(), double.unwrap());
        println!("{convention:?}: {single} events in f32, {double} in f64");
        assert!(single > 5_000 && double > 5_000);
    }
}

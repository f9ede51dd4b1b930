//! Laws that hold for every motion and every valid parameter set.

mod support;

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, EVENTS_PER_STEP, EventKind, Parameters, Phase, Real, Settings, ShaftStep, StickSlip,
};
use proptest::prelude::*;

/// Any stick-slip object that makes sense at 20 kHz, and many that do not.
fn settings() -> impl Strategy<Value = Settings> {
    let parameters = (
        -6.0..1.0_f64,
        -1.0..5.0_f64,
        0.0..1.0_f64,
        -3.0..1.0_f64,
        prop_oneof![Just(0.0), 1e-4..5.0_f64],
    );
    (parameters, 0..3_usize).prop_map(|((j, kr, ratio, ts, zeta), convention)| {
        let convention = Convention::ALL[convention];
        let static_torque_nm = 10_f64.powf(ts);
        let mut parameters = Parameters {
            inertia_kg_m2: 10_f64.powf(j),
            stiffness_nm_per_rad: 10_f64.powf(kr),
            damping_nms_per_rad: 0.0,
            kinetic_torque_nm: ratio * static_torque_nm,
            static_torque_nm,
        };
        if convention != Convention::Frozen {
            parameters.damping_nms_per_rad = 2.0 * zeta * parameters.impedance_nms_per_rad();
        }
        Settings {
            parameters,
            convention,
            ..Settings::default()
        }
    })
}

/// A shaft that wanders, rests and jumps.
fn motion() -> impl Strategy<Value = Vec<ShaftStep<f64>>> {
    let knot = (
        -20.0..20.0_f64,
        prop_oneof![3 => Just(false), 1 => Just(true)],
        0..4_u8,
    );
    prop::collection::vec(knot, 1..30).prop_map(|knots| {
        let mut steps = Vec::new();
        let mut omega = 0.0;
        for (target, jump, kind) in knots {
            let target = if kind == 0 { 0.0 } else { target };
            let start = if jump { target } else { omega };
            for i in 0..10 {
                let at = |n: u8| start + (target - start) * f64::from(n) / 10.0;
                let (a, b) = (at(i), at(i + 1));
                steps.push(ShaftStep {
                    delta_phi_rad: f64::midpoint(a, b) * 5e-5,
                    omega_start_rad_s: a,
                    omega_end_rad_s: b,
                });
            }
            omega = target;
        }
        steps
    })
}

/// Steps a joint and checks every law on the way.
struct Check<'a> {
    steps: &'a [ShaftStep<f64>],
    settings: Settings,
    sign: f64,
}

impl<F: Real> JointVisitor<F> for Check<'_> {
    type Output = Vec<(Phase, u64)>;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Self::Output {
        let limit = F::from_f64(self.settings.parameters.static_torque_nm);
        let mut outputs = Vec::new();
        for step in self.steps {
            let step = ShaftStep {
                delta_phi_rad: F::from_f64(self.sign * step.delta_phi_rad),
                omega_start_rad_s: F::from_f64(self.sign * step.omega_start_rad_s),
                omega_end_rad_s: F::from_f64(self.sign * step.omega_end_rad_s),
            };
            let (mut events, mut last, mut phase) = (0, F::ZERO, joint.phase());
            joint.step(&step, |e| {
                events += 1;
                assert!(
                    e.fraction >= last && e.fraction <= F::ONE,
                    "order of events"
                );
                assert!(
                    e.from == phase && e.to != e.from,
                    "phases follow each other"
                );
                let kind = match (e.from, e.to) {
                    (Phase::Stick, _) => EventKind::Break,
                    (_, Phase::Stick) => EventKind::Stick,
                    _ => EventKind::Reverse,
                };
                assert_eq!(e.kind, kind, "an event is called what it is");
                assert!(e.torque_before_nm.abs() <= limit && e.torque_after_nm.abs() <= limit);
                (last, phase) = (e.fraction, e.to);
            });
            assert!(events <= EVENTS_PER_STEP, "{events} events");
            assert_eq!(joint.phase(), phase);
            let torque = joint.torque_nm();
            assert!(torque.abs() <= limit, "{torque:?} above {limit:?}");
            assert!(joint.theta_rad().is_finite() && joint.theta_dot_rad_s().is_finite());
            outputs.push((
                joint.phase(),
                (F::from_f64(self.sign) * torque).abs().to_f64().to_bits(),
            ));
        }
        outputs
    }
}

fn check<F: Real>(settings: Settings, solver: Solver, steps: &[ShaftStep<f64>]) {
    let valid = settings.validate().expect("valid settings");
    let run = |sign: f64| {
        let omega = F::from_f64(sign * steps[0].omega_start_rad_s);
        with_joint::<F, _>(
            &valid,
            solver,
            5e-5,
            omega,
            Check {
                steps,
                settings,
                sign,
            },
        )
        .expect("a good step")
    };
    for (a, b) in run(1.0).iter().zip(&run(-1.0)) {
        assert_eq!((a.0.sign(), a.1), (-b.0.sign(), b.1), "the mirrored motion");
    }
}

proptest! {
    #![proptest_config(support::cases(5000))]

    #[test]
    fn torque_is_bounded_events_are_ordered_and_the_mirror_is_exact(
        settings in settings(),
        steps in motion(),
    ) {
        let explicit = [Solver::Euler, Solver::SemiImplicitEuler, Solver::Verlet, Solver::Rk4, Solver::Rk4Events];
        for solver in Solver::ALL {
            // Explicit methods have a limit of stability, and no laws beyond.
            let radians = settings.parameters.natural_rad_s() * 5e-5;
            let damped = settings.parameters.damping_nms_per_rad / settings.parameters.inertia_kg_m2 * 5e-5;
            let unstable = explicit.contains(&solver) && (radians > 0.5 || damped > 0.5);
            if unstable || solver.refusal(settings.convention).is_some() {
                continue;
            }
            check::<f64>(settings, solver, &steps);
            if solver.refusal_in::<f32>(settings.convention).is_none() {
                check::<f32>(settings, solver, &steps);
            }
        }
    }
}

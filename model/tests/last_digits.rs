//! Cases that planted faults found untested: numbers that only their last digits, or
//! a gap, tell apart.
#![allow(missing_docs)]

use crepitus_model::render::Limit;
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, Frozen, Guarded, Parameters, Renderer, Sample, Settings, ShaftStep,
    StepCoefficients, StickSlip,
};

const TICK_S: f64 = 5e-5;

fn coefficients(parameters: Parameters) -> StepCoefficients<f32> {
    let settings = Settings {
        parameters,
        ..Settings::default()
    };
    StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap()
}

#[test]
fn a_period_in_single_precision_keeps_its_fraction_of_a_tick() {
    // 2π/(200 rad/s · 50 µs).
    let period = coefficients(Parameters::default()).period;
    assert_eq!(period.whole, 628);
    assert!((f64::from(period.fraction) - 0.318_530_717_958_6).abs() < 1e-7);
}

#[test]
fn a_ramp_never_lifts_the_kinetic_torque_above_the_static_one() {
    for (kinetic_nm, static_nm, equal_nm) in [
        (0.139_999_991_6, 0.14, 0.461),
        (0.077_999_981_28, 0.078, 0.399),
        (0.015_999_992_32, 0.016, 0.146),
    ] {
        let torques = |kinetic_torque_nm, static_torque_nm| {
            coefficients(Parameters {
                kinetic_torque_nm,
                static_torque_nm,
                ..Parameters::default()
            })
        };
        let (from, to) = (torques(kinetic_nm, static_nm), torques(equal_nm, equal_nm));
        let mut ramp = Ramp::new(from, to, 100.0);
        while let Some(now) = ramp.advance() {
            assert!(now.kinetic_nm <= now.static_nm, "{static_nm}: {now:?}");
        }
    }
}

#[test]
fn after_a_gap_a_joint_resumes_from_the_present_torque() {
    let joint = Frozen::<f32, ExactEvents>::new(coefficients(Parameters::default()), 0.1);
    let mut joint = Guarded::new(joint, InputLimits::device(TICK_S), 0.1);
    let moved = Sample::Taken(ShaftStep {
        delta_phi_rad: 5e-6,
        omega_start_rad_s: 0.1,
        omega_end_rad_s: 0.1,
    });
    for _ in 0..100 {
        joint.tick(&moved, |_| {});
    }
    for _ in 0..10 {
        joint.tick(&Sample::Lost, |_| {});
    }
    let held_nm = joint.torque_nm();
    assert!((held_nm - 0.2).abs() < 1e-6);
    joint.tick(&moved, |_| {});
    assert!((joint.torque_nm() - held_nm).abs() < 1e-6);
}

#[test]
fn after_a_gap_nothing_comes_back_of_a_torque_that_was_switched_off() {
    const COUNT_RAD: f32 = 3.6e-5;
    let moved = |delta_phi_rad| {
        Sample::Taken(ShaftStep {
            delta_phi_rad,
            omega_start_rad_s: 1.0,
            omega_end_rad_s: 1.0,
        })
    };
    let mut joint = Renderer::<f32, ExactEvents>::of(
        coefficients(Parameters::default()),
        InputLimits::device(TICK_S),
        COUNT_RAD,
        1.0,
    );
    for _ in 0..40 {
        joint.render(&moved(5e-5), |_| {});
    }
    assert!(joint.render(&moved(-3.0 * COUNT_RAD), |_| {}).limit == Limit::TurnedBack);
    for _ in 0..10 {
        assert_eq!(joint.render(&Sample::Lost, |_| {}).torque_nm, 0.0);
    }
    let shown = joint.render(&moved(0.0), |_| {});
    assert_eq!(shown.limit, Limit::None);
    assert_eq!(shown.torque_nm, 0.0);
}

/// A damped object that slides endlessly.
struct Decay;

impl JointVisitor<f32> for Decay {
    type Output = ();

    fn visit<J: StickSlip<f32>>(self, mut joint: J) {
        let steady = ShaftStep {
            delta_phi_rad: 1e-3,
            omega_start_rad_s: 1.0,
            omega_end_rad_s: 1.0,
        };
        for _ in 0..20_000 {
            joint.step(&steady, |_| {});
            assert!(!joint.theta_dot_rad_s().is_subnormal());
        }
        assert_eq!(joint.theta_dot_rad_s(), 0.0);
    }
}

#[test]
fn a_decay_ends_at_rest_and_not_in_subnormal_numbers() {
    let mut settings = Settings {
        convention: Convention::Physical,
        ..Settings::default()
    };
    settings.parameters.damping_nms_per_rad = 2.0;
    let settings = settings.validate().unwrap();
    with_joint(&settings, Solver::ExactEvents, 1e-3, 1.0, Decay).unwrap();
}

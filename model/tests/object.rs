//! The imaginary object of a frozen joint, which nothing needs for the torque
//! and every picture shows: where it is, and how it goes on when its numbers
//! change or the shaft was out of sensing.

use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Parameters, Phase, Sense, Settings, ShaftStep, StepCoefficients, StickSlip,
};

const TICK_S: f64 = 5e-5;

type Joint = Frozen<f64, ExactEvents>;

fn coefficients(parameters: Parameters) -> StepCoefficients<f64> {
    let settings = Settings {
        parameters,
        ..Settings::default()
    };
    StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap()
}

fn paper() -> Parameters {
    Parameters::default()
}

fn steady(omega: f64) -> ShaftStep<f64> {
    ShaftStep {
        delta_phi_rad: omega * TICK_S,
        omega_start_rad_s: omega,
        omega_end_rad_s: omega,
    }
}

/// A joint after this many ticks at this speed.
fn after(ticks: u32, omega: f64) -> Joint {
    let mut joint = Joint::new(coefficients(paper()), omega);
    for _ in 0..ticks {
        joint.step(&steady(omega), |_| {});
    }
    joint
}

#[test]
fn in_a_slip_the_object_swings_freely_from_where_it_broke() {
    // Break at θ = s·1 mrad with θ̇ = Ω; about s·0.5 mrad, at 200 rad/s.
    for (omega, sign) in [(0.97_f64, 1.0), (-0.97, -1.0)] {
        let break_s = 1e-3 / omega.abs();
        for ticks in [40, 200, 431, 600] {
            let joint = after(ticks, omega);
            let sense = if sign > 0.0 {
                Sense::Positive
            } else {
                Sense::Negative
            };
            assert_eq!(joint.phase(), Phase::Slip(sense));
            let angle = 200.0 * (f64::from(ticks) * TICK_S - break_s);
            let (x, v) = (sign * 5e-4, omega);
            let theta = x + x * angle.cos() + v / 200.0 * angle.sin();
            let theta_dot = v * angle.cos() - 200.0 * x * angle.sin();
            assert!((joint.theta_rad() - theta).abs() < 1e-14, "{ticks}");
            assert!(
                (joint.theta_dot_rad_s() - theta_dot).abs() < 1e-12,
                "{ticks}"
            );
        }
    }
}

#[test]
fn in_a_stick_the_object_moves_with_the_shaft() {
    let joint = after(15, 0.97);
    assert_eq!(joint.phase(), Phase::Stick);
    assert_eq!(joint.theta_dot_rad_s(), 0.97);
    assert!((joint.theta_rad() - 15.0 * 0.97 * TICK_S).abs() < 1e-18);
}

#[test]
fn slips_are_numbered() {
    let mut joint = Joint::new(coefficients(paper()), 1.0);
    let mut breaks = 0;
    for _ in 0..4000 {
        joint.step(&steady(1.0), |e| {
            breaks += u32::from(e.from == Phase::Stick);
        });
        assert_eq!(joint.slip_number(), breaks);
    }
    assert_eq!(breaks, 7);
}

#[test]
fn the_same_numbers_change_nothing() {
    for ticks in [15, 300] {
        let (mut joint, same) = (after(ticks, 0.97), after(ticks, 0.97));
        joint.adjust(coefficients(paper()));
        assert_eq!(joint.phase(), same.phase());
        assert!((joint.theta_rad() - same.theta_rad()).abs() < 1e-16);
        assert!((joint.theta_dot_rad_s() - same.theta_dot_rad_s()).abs() < 1e-13);
        assert_eq!(joint.torque_nm(), same.torque_nm());
    }
}

#[test]
fn a_ramp_that_goes_nowhere_loses_no_rounding_error() {
    // A stick carries the error of its sum: a second of small steps in f32.
    let numbers =
        StepCoefficients::<f32>::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
    let step = ShaftStep {
        delta_phi_rad: 1.37e-8,
        omega_start_rad_s: 2.7e-4,
        omega_end_rad_s: 2.7e-4,
    };
    let mut plain = Frozen::<f32, ExactEvents>::new(numbers, 2.7e-4);
    let mut adjusted = plain.clone();
    for _ in 0..20_000 {
        plain.step(&step, |_| {});
        adjusted.adjust(numbers);
        adjusted.step(&step, |_| {});
    }
    assert_eq!(plain.torque_nm(), adjusted.torque_nm());
}

#[test]
fn a_break_is_reported_with_all_that_is_known() {
    for (omega, s) in [(0.97, 1.0), (-0.97, -1.0)] {
        let mut joint = Joint::new(coefficients(paper()), omega);
        let mut seen = Vec::new();
        for _ in 0..700 {
            joint.step(&steady(omega), |e| seen.push(e));
        }
        let [b, e, ..] = seen[..] else {
            panic!("{seen:?}")
        };
        assert!((b.torque_before_nm - s * 0.4).abs() < 1e-15);
        assert!((b.theta_rad - s * 1e-3).abs() < 1e-18);
        assert_eq!((b.torque_after_nm, e.torque_before_nm), (s * 0.2, s * 0.2));
        assert_eq!((b.theta_dot_rad_s, b.omega_rad_s), (omega, omega));
        assert!(e.torque_after_nm.abs() < 1e-15 && e.theta_rad.abs() < 1e-18);
        assert_eq!((e.theta_dot_rad_s, e.omega_rad_s), (omega, omega));
    }
}

#[test]
fn a_soft_spring_breaks_at_the_same_torque() {
    // Ts/kr = 4 rad, in one step of 5 rad.
    let soft = Parameters {
        stiffness_nm_per_rad: 0.1,
        ..paper()
    };
    for s in [1.0, -1.0] {
        let mut joint = Joint::new(coefficients(soft), s * 1e5);
        let mut seen = Vec::new();
        joint.step(&steady(s * 1e5), |e| seen.push(e));
        assert_eq!(seen.len(), 1);
        assert!((seen[0].theta_rad - s * 4.0).abs() < 1e-14);
        assert!((seen[0].torque_before_nm - s * 0.4).abs() < 1e-15);
    }
}

#[test]
fn in_stick_a_stiffer_spring_keeps_its_torque_and_a_softer_one_its_angle() {
    let with = |stiffness_nm_per_rad| {
        coefficients(Parameters {
            stiffness_nm_per_rad,
            ..paper()
        })
    };
    let mut joint = after(15, 0.97);
    let (theta, torque) = (joint.theta_rad(), joint.torque_nm());
    joint.adjust(with(1600.0));
    assert!((joint.torque_nm() - torque).abs() < 1e-15);
    assert!((joint.theta_rad() - theta / 4.0).abs() < 1e-18);
    joint.adjust(with(400.0));
    assert!((joint.theta_rad() - theta / 4.0).abs() < 1e-18);
    assert!((joint.torque_nm() - torque / 4.0).abs() < 1e-15);
}

#[test]
fn in_a_slip_the_object_goes_on_from_where_it_is() {
    let change = |parameters: Parameters| {
        let mut joint = after(300, 0.97);
        let before = (joint.theta_rad(), joint.theta_dot_rad_s());
        joint.adjust(coefficients(parameters));
        (before, (joint.theta_rad(), joint.theta_dot_rad_s()))
    };
    // Friction torques move the centre of the swing, not the object.
    let ((theta, v), now) = change(Parameters {
        kinetic_torque_nm: 0.3,
        ..paper()
    });
    assert!((now.0 - theta).abs() < 1e-16 && (now.1 - v).abs() < 1e-13);
    // A heavier object slows down so far that it holds no more energy.
    let ((theta, v), now) = change(Parameters {
        inertia_kg_m2: 0.04,
        ..paper()
    });
    assert!((now.0 - theta).abs() < 1e-16 && (now.1 - v / 2.0).abs() < 1e-13);
    // A lighter one does not speed up, a stiffer spring is wound as far as it
    // holds the torque.
    let ((theta, v), now) = change(Parameters {
        inertia_kg_m2: 0.0025,
        stiffness_nm_per_rad: 800.0,
        ..paper()
    });
    assert!((now.0 - theta / 2.0).abs() < 1e-16 && (now.1 - v).abs() < 1e-13);
}

#[test]
fn a_slip_that_began_with_a_soft_spring_ends_within_what_that_held() {
    // Ts/kr of the softer spring, scaled as θ is: 0.4 N·m at 800 N·m/rad.
    let strong = |stiffness_nm_per_rad| Parameters {
        kinetic_torque_nm: 2.0,
        static_torque_nm: 2.1,
        stiffness_nm_per_rad,
        ..paper()
    };
    for (stiffness, torque) in [(800.0, 0.4), (100.0, 0.1)] {
        let mut joint = after(300, 0.97);
        joint.adjust(coefficients(strong(stiffness)));
        let mut sticks = Vec::new();
        for _ in 0..2000 {
            joint.step(&steady(0.97), |e| {
                if e.to == Phase::Stick && sticks.is_empty() {
                    sticks.push(e.torque_after_nm);
                }
            });
        }
        assert!(
            (sticks[0] - torque).abs() < 1e-12,
            "{stiffness}: {sticks:?}"
        );
    }
}

#[test]
fn a_restart_is_a_stick_with_the_given_torque() {
    for (asked, shown) in [(0.15, 0.15), (-0.3, -0.3), (0.9, 0.4), (-0.9, -0.4)] {
        let mut joint = after(300, 0.97);
        joint.restart(asked, -0.5);
        assert_eq!(joint.phase(), Phase::Stick);
        assert!((joint.torque_nm() - shown).abs() < 1e-15);
        assert_eq!(joint.theta_dot_rad_s(), -0.5);
        assert!((joint.theta_rad() - shown / 400.0).abs() < 1e-18);
        // From there it continues like any stick.
        joint.step(&steady(-0.1), |_| {});
        let expected = (shown - 400.0 * 0.1 * TICK_S).max(-0.4);
        let broke = matches!(joint.phase(), Phase::Slip(Sense::Negative));
        assert!(broke || (joint.torque_nm() - expected).abs() < 1e-12);
    }
}

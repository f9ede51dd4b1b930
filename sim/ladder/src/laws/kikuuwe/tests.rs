//! The law against the inclusion that it solves, and its closed forms.

use super::*;
use crepitus_model::Parameters;
use std::vec::Vec;

const H: f64 = 5e-5;

fn contact() -> Contact {
    Contact::direct(&Parameters {
        kinetic_torque_nm: 0.25,
        ..Parameters::default()
    })
}

fn damped() -> Contact {
    Contact {
        damping_nms_per_rad: 0.05,
        ..contact()
    }
}

fn travel<F: Real>(law: &mut Kikuuwe<F>, delta_rad: f64) -> f64 {
    let shaft = ShaftStep {
        delta_phi_rad: F::from_f64(delta_rad),
        omega_start_rad_s: F::ZERO,
        omega_end_rad_s: F::ZERO,
    };
    law.step(&shaft).to_f64()
}

fn run<F: Real>(law: &mut Kikuuwe<F>, delta_rad: f64, steps: usize) -> Vec<f64> {
    (0..steps).map(|_| travel(law, delta_rad)).collect()
}

/// Numbers in ±1, the same in every run.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[test]
fn presliding_has_the_stiffness_of_the_contact_and_breaks_at_ts() {
    let contact = contact();
    let (k, ts) = (contact.stiffness_nm_per_rad, contact.static_torque_nm);
    let delta = 0.73 * H;
    let mut law = Kikuuwe::<f64>::new(&contact, H);
    let torques = run(&mut law, delta, 200);
    for (torque, n) in torques.iter().zip(1_u32..) {
        let elastic = k * delta * f64::from(n);
        if elastic < ts {
            assert!((torque / elastic - 1.0).abs() < 1e-9, "{n}: {torque}");
        }
    }
    // The break shows Ts itself, after a torque that is one step away.
    let at = torques.iter().position(|t| *t == ts).unwrap();
    assert!(torques[at - 1] > ts - k * delta);
    assert!(torques[at + 1..].iter().all(|t| *t == 0.25));
    assert!(torques.len() - at > 150);
}

#[test]
fn at_constant_velocity_it_slides_at_tk_at_any_step() {
    for contact in [contact(), damped()] {
        for h in [1e-5, 1e-3, 1e-2] {
            for omega in [-3.0, -0.01, 0.3, 20.0] {
                let mut law = Kikuuwe::<f64>::new(&contact, h);
                let steps = (0.1 / (omega * h).abs()) as usize + 3;
                let torques = run(&mut law, omega * h, steps);
                assert_eq!(torques[steps - 1], omega.signum() * 0.25, "{h} {omega}");
            }
        }
    }
}

/// For any motion T = K·e + B·ė holds, and T lies in F·sgn(v) with the level stated.
#[test]
fn every_step_solves_the_inclusion() {
    let mut slips = 0;
    for contact in [contact(), damped()] {
        let mut random = noise();
        let mut law = Kikuuwe::<f64>::new(&contact, H);
        let (k, b) = (contact.stiffness_nm_per_rad, contact.damping_nms_per_rad);
        for n in 0..100_000_u32 {
            let (before, sense) = (law.spring.value() / k, law.slip);
            let delta = 1e-3 * random() * Real::sin_cos(f64::from(n) * 1e-3).0;
            let torque = travel(&mut law, delta);
            let after = law.spring.value() / k;
            let rate = (after - before) / H;
            assert!((torque - k * after - b * rate).abs() < 1e-12, "{n}");
            let slip = delta - (after - before);
            if slip.abs() > 1e-14 {
                slips += 1;
                let same = sense.is_some_and(|s| s.of_signed(1.0) == slip.signum());
                let level = if same { 0.25 } else { 0.4 };
                assert_eq!(torque, slip.signum() * level, "{n}");
            } else {
                assert!(torque.abs() <= 0.4, "{n}");
            }
        }
    }
    assert!(slips > 10_000, "{slips}");
}

#[test]
fn long_steps_and_stiff_contacts_are_stable_and_at_rest_nothing_moves() {
    for stiffness_nm_per_rad in [4e2, 4e5, 4e9] {
        for damping_nms_per_rad in [0.0, 0.05, 50.0] {
            for h in [5e-5, 1e-3, 1e-2] {
                let contact = Contact {
                    stiffness_nm_per_rad,
                    damping_nms_per_rad,
                    ..contact()
                };
                let mut law = Kikuuwe::<f64>::new(&contact, h);
                let mut random = noise();
                let unit = 0.5 / (stiffness_nm_per_rad + damping_nms_per_rad / h);
                for _ in 0..100 {
                    let drive = unit * (1.0 + random());
                    for _ in 0..20 {
                        assert!(travel(&mut law, drive * random()).abs() <= 0.4);
                    }
                    // A break on the last step is followed by its fall.
                    travel(&mut law, 0.0);
                    let rest = travel(&mut law, 0.0);
                    for _ in 0..20 {
                        assert!((travel(&mut law, 0.0) - rest).abs() <= 1e-16);
                    }
                }
            }
        }
    }
}

/// Torque at the end of a sine's second cycle, and its mean error beside a fine run.
fn sine(contact: &Contact, amplitude_rad: f64, steps: u32) -> Vec<f64> {
    let h = 2.0 / f64::from(steps);
    let angle = |n: u32| amplitude_rad * Real::sin_cos(core::f64::consts::TAU * f64::from(n) * h).0;
    let mut law = Kikuuwe::<f64>::new(contact, h);
    (0..steps)
        .map(|n| travel(&mut law, angle(n + 1) - angle(n)))
        .collect()
}

fn mean_error(contact: &Contact, amplitude_rad: f64, steps: u32) -> f64 {
    const FINE: u32 = 1 << 21;
    let fine = sine(contact, amplitude_rad, FINE);
    let coarse = sine(contact, amplitude_rad, steps);
    let stride = (FINE / steps) as usize;
    let exact = fine.iter().skip(stride - 1).step_by(stride);
    let sum: f64 = coarse.iter().zip(exact).map(|(a, b)| (a - b).abs()).sum();
    sum / f64::from(steps)
}

#[test]
fn it_converges_with_the_first_order() {
    let contact = Contact {
        damping_nms_per_rad: 4.0,
        ..contact()
    };
    // In stick against the closed form K·φ + B·φ̇.
    let amplitude = 5e-4;
    let error = |steps: u32| {
        let torques = sine(&contact, amplitude, steps);
        let omega = core::f64::consts::TAU;
        let error = |(torque, n): (&f64, u32)| {
            let (sin, cos) = Real::sin_cos(omega * 2.0 * f64::from(n) / f64::from(steps));
            (torque - amplitude * (400.0 * sin + 4.0 * omega * cos)).abs()
        };
        torques.iter().zip(1..).map(error).fold(0.0, f64::max)
    };
    let ratio = error(1_000) / error(2_000);
    assert!((1.98..2.02).contains(&ratio), "{ratio}");
    // With breaks, slips and reversals against a fine run, in the mean.
    let errors = [1 << 10, 1 << 12, 1 << 14].map(|steps| mean_error(&contact, 3e-3, steps));
    let order = |ratio: f64| 0.5 * ratio.log2();
    for pair in errors.windows(2) {
        let order = order(pair[0] / pair[1]);
        assert!((0.8..1.2).contains(&order), "{order}: {errors:?}");
    }
}

fn drift<F: Real>(contact: &Contact, tolerance: f64) {
    let part = 0.5 * contact.static_torque_nm / contact.stiffness_nm_per_rad / 7.0;
    let mut law = Kikuuwe::<F>::new(contact, 1e-2);
    run(&mut law, part, 3);
    let mut cycle = || {
        run(&mut law, part, 7);
        run(&mut law, -part, 14);
        run(&mut law, part, 7);
        travel(&mut law, 0.0)
    };
    let first = cycle();
    for n in 1..10_000 {
        let torque = cycle();
        assert!((torque - first).abs() <= tolerance, "{n}: {torque} {first}");
    }
}

#[test]
fn ten_thousand_small_cycles_do_not_drift() {
    for contact in [contact(), damped()] {
        drift::<f64>(&contact, 1e-15);
        drift::<f32>(&contact, 1e-7);
    }
}

/// Steps of a rounding error of the torque, as of a shaft that hardly moves.
#[test]
fn a_million_small_steps_lose_nothing_in_single_precision() {
    let mut law = Kikuuwe::<f32>::new(&contact(), H);
    let torques = run(&mut law, 0.9e-9, 1_000_000);
    assert!((torques[999_999] - 0.36).abs() < 1e-7);
}

#[test]
fn a_reversal_begins_with_the_stiffness_of_the_contact() {
    let contact = contact();
    for sign in [1.0, -1.0] {
        for steps in [500, 4_321] {
            let mut law = Kikuuwe::<f64>::new(&contact, H);
            let before = run(&mut law, sign * 1e-6, steps)[steps - 1];
            let torque = travel(&mut law, -sign * 1e-6);
            assert!(((before - torque) / (sign * 400e-6) - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn steps_without_motion_do_not_end_a_slip_and_a_step_back_does() {
    let mut law = Kikuuwe::<f64>::new(&contact(), H);
    run(&mut law, 1e-5, 500);
    for n in 0..1_000 {
        // A count in ten steps.
        let torque = travel(&mut law, if n % 10 == 0 { 1e-4 } else { 0.0 });
        assert_eq!(torque, 0.25);
    }
    travel(&mut law, -1e-6);
    let again = run(&mut law, 1e-5, 500);
    assert_eq!(again.iter().fold(0.0, |a: f64, b| a.max(*b)), 0.4);
}

#[test]
fn other_parameters_keep_the_torque_within_the_new_ts() {
    let before = contact();
    let stiffer = Contact {
        static_torque_nm: 0.5,
        stiffness_nm_per_rad: 1_000.0,
        ..before
    };
    let weaker = Contact {
        static_torque_nm: 0.1,
        kinetic_torque_nm: 0.08,
        ..before
    };
    for (after, expected) in [(stiffer, 0.32), (weaker, 0.1)] {
        let mut law = Kikuuwe::<f64>::new(&before, H);
        travel(&mut law, 0.32 / 400.0);
        law.change(&after, 1e-4);
        assert!((travel(&mut law, 0.0) - expected).abs() < 1e-15);
        travel(&mut law, -1e-5);
        let torque = law.spring.value();
        let slope = (torque - travel(&mut law, -1e-6)) / 1e-6;
        assert!((slope / after.stiffness_nm_per_rad - 1.0).abs() < 1e-9);
    }
    // In a slip: a larger Tk is reached from where the torque is, a smaller one at once.
    for (kinetic_torque_nm, expected) in [(0.3, 0.25), (0.2, 0.2)] {
        let mut law = Kikuuwe::<f64>::new(&before, H);
        run(&mut law, 1e-5, 500);
        law.change(
            &Contact {
                kinetic_torque_nm,
                ..before
            },
            H,
        );
        assert!((travel(&mut law, 1e-9) - expected).abs() < 1e-6);
    }
}

//! The law against its closed forms.

use super::*;
use crepitus_model::Parameters;
use std::vec::Vec;

fn contact() -> Contact {
    Contact::direct(&Parameters {
        kinetic_torque_nm: 0.25,
        ..Parameters::default()
    })
}

fn law<F: Real>(contact: &Contact) -> HaywardArmstrong<F> {
    let parameters = <HaywardArmstrong<F> as FrictionLaw<F>>::fitted(contact);
    HaywardArmstrong::new(&parameters, 5e-5)
}

fn travel<F: Real>(law: &mut HaywardArmstrong<F>, delta_rad: f64) -> f64 {
    let shaft = ShaftStep {
        delta_phi_rad: F::from_f64(delta_rad),
        omega_start_rad_s: F::ZERO,
        omega_end_rad_s: F::ZERO,
    };
    law.step(&shaft).to_f64()
}

/// Torques along `steps` equal steps.
fn run<F: Real>(law: &mut HaywardArmstrong<F>, delta_rad: f64, steps: usize) -> Vec<f64> {
    (0..steps).map(|_| travel(law, delta_rad)).collect()
}

fn falls(torques: &[f64]) -> usize {
    torques.windows(2).filter(|w| w[1] < w[0]).count()
}

#[test]
fn presliding_has_the_stiffness_of_the_contact_and_bears_ts() {
    let contact = contact();
    let (k, ts) = (contact.stiffness_nm_per_rad, contact.static_torque_nm);
    let mut law = law::<f64>(&contact);
    let (mut largest, mut phi) = (0.0_f64, 0.0);
    for n in 1..=2_000_u32 {
        phi = f64::from(n) * 1e-6;
        let torque = travel(&mut law, 1e-6);
        if k * phi < ts - 1e-9 {
            assert!((torque / (k * phi) - 1.0).abs() < 1e-9, "{n}: {torque}");
        }
        largest = largest.max(torque);
    }
    assert!(k * phi > ts, "the travel goes beyond the break");
    assert!(largest <= ts && largest >= ts - k * 1e-6, "{largest}");
}

#[test]
fn at_constant_velocity_it_oscillates_about_tk() {
    let contact = contact();
    let (ts, tk) = (contact.static_torque_nm, contact.kinetic_torque_nm);
    let (k, restart) = (contact.stiffness_nm_per_rad, 2.0 * tk - ts);
    let (cycle, end) = (2.0 * (ts - tk) / k, 1.234);
    // From rest the first break is after Ts/k. Steps up to a third of a cycle: every break is a fall.
    let breaks = ((end - ts / k) / cycle).floor() + 1.0;
    let mut ends = Vec::new();
    for steps in [5_000_u32, 24_680, 100_000, 1_000_000] {
        let delta = end / f64::from(steps);
        let torques = run(&mut law::<f64>(&contact), delta, steps as usize);
        assert_eq!(falls(&torques), breaks as usize, "{steps}");
        let sliding = &torques[(2.0 * ts / k / delta) as usize..];
        let mean = sliding.iter().sum::<f64>() / sliding.len() as f64;
        // Part of a cycle at each end, and the mean of a saw-tooth's samples.
        assert!((mean - tk).abs() < 1e-3 * (ts - tk) + k * delta * 0.5);
        let least = sliding.iter().fold(f64::MAX, |a, b| a.min(*b));
        let most = sliding.iter().fold(f64::MIN, |a, b| a.max(*b));
        assert!(least >= restart - 1e-12 && least < restart + k * delta);
        assert!(most <= ts && most > ts - k * delta);
        ends.push(torques[torques.len() - 1]);
    }
    // The cycles lose nothing at their breaks, however long the step.
    let rest = restart + k * ((end - ts / k) - (breaks - 1.0) * cycle);
    for torque in ends {
        assert!((torque - rest).abs() < 1e-9, "{torque} {rest}");
    }
}

#[test]
fn a_step_over_many_cycles_ends_where_small_steps_do() {
    let contact = contact();
    for (sign, whole) in [(1.0, 0.0123), (-1.0, 0.0777), (1.0, 3.3)] {
        let one = travel(&mut law::<f64>(&contact), sign * whole);
        let many = run(&mut law::<f64>(&contact), sign * whole / 1e5, 100_000);
        assert!((one - many[99_999]).abs() < 1e-9, "{whole}: {one}");
        assert_eq!(one.signum(), sign);
    }
}

#[test]
fn the_same_angles_give_the_same_torques_at_any_rate() {
    let parameters = <HaywardArmstrong<f64> as FrictionLaw<f64>>::fitted(&contact());
    let torques = |step_s: f64| -> Vec<u64> {
        let mut law = HaywardArmstrong::<f64>::new(&parameters, step_s);
        let mut torque = |n: u32| {
            let delta_phi_rad = 3e-4 * sine(f64::from(n) * 0.37);
            law.step(&ShaftStep {
                delta_phi_rad,
                omega_start_rad_s: delta_phi_rad / step_s,
                omega_end_rad_s: delta_phi_rad / step_s,
            })
        };
        (0..5_000).map(|n| torque(n).to_bits()).collect()
    };
    let slow = torques(1e-2);
    assert!(falls(&slow.iter().map(|b| f64::from_bits(*b)).collect::<Vec<_>>()) > 1_000);
    for step_s in [1e-6, 5e-5, 1e-3] {
        assert_eq!(torques(step_s), slow, "{step_s}");
    }
}

fn sine(x: f64) -> f64 {
    Real::sin_cos(x).0
}

fn drift<F: Real>(tolerance: f64) {
    let contact = contact();
    let part = 0.5 * contact.static_torque_nm / contact.stiffness_nm_per_rad / 7.0;
    let mut law = law::<F>(&contact);
    // A load, and a tremor on it that stays within the break-away.
    travel(&mut law, 3.0 * part);
    let mut cycle = || {
        run(&mut law, part, 7);
        run(&mut law, -part, 14);
        run(&mut law, part, 7)[6]
    };
    let first = cycle();
    for n in 1..10_000 {
        let torque = cycle();
        assert!((torque - first).abs() <= tolerance, "{n}: {torque} {first}");
    }
}

#[test]
fn ten_thousand_small_cycles_do_not_drift() {
    drift::<f64>(1e-15);
    drift::<f32>(1e-7);
}

/// Steps of a rounding error of the torque, as of a shaft that hardly moves.
#[test]
fn a_million_small_steps_lose_nothing_in_single_precision() {
    let mut law = law::<f32>(&contact());
    let torques = run(&mut law, 0.9e-9, 1_000_000);
    assert!((torques[999_999] - 0.36).abs() < 1e-7);
}

#[test]
fn a_reversal_begins_with_the_stiffness_of_the_contact() {
    let contact = contact();
    let k = contact.stiffness_nm_per_rad;
    for sign in [1.0, -1.0] {
        for steps in [500, 4_321, 7_000] {
            let mut law = law::<f64>(&contact);
            let before = run(&mut law, sign * 1e-6, steps)[steps - 1];
            let torque = travel(&mut law, -sign * 1e-6);
            assert!(((before - torque) / (sign * k * 1e-6) - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn equal_torques_slide() {
    let contact = Contact {
        kinetic_torque_nm: 0.4,
        ..contact()
    };
    for sign in [1.0, -1.0] {
        let torques = run(&mut law::<f64>(&contact), sign * 1e-5, 1_000);
        let broken = torques.iter().skip_while(|t| t.abs() < 0.4);
        assert!(broken.clone().count() > 890);
        assert!(broken.clone().all(|t| *t == sign * 0.4));
    }
}

/// z_stick = 0 is the law of Dahl: T = Ts·(1 − exp(−k·x/Ts)) from rest, and it converges to that.
#[test]
fn creep_is_dahls_and_converges_with_the_displacement() {
    let parameters = AdhesionParameters {
        stiffness_nm_per_rad: 400.0,
        stick_nm: 0.0,
        slide_nm: 0.4,
    };
    let error = |steps: u32| {
        let mut law = HaywardArmstrong::<f64>::new(&parameters, 1e-3);
        let torques = run(&mut law, 1.5e-3 / f64::from(steps), steps as usize);
        let exact = 0.4 * (1.0 - Real::exp(-400.0 * 1.5e-3 / 0.4));
        (torques[torques.len() - 1] - exact).abs()
    };
    let (coarse, fine) = (error(100), error(200));
    assert!(coarse < 2e-3 && (1.9..2.1).contains(&(coarse / fine)));
    // A long travel slides at z_slide, and a huge step does no more.
    let mut law = HaywardArmstrong::<f64>::new(&parameters, 1e-3);
    assert!((run(&mut law, 1e-5, 3_000)[2_999] - 0.4).abs() < 1e-9);
    assert_eq!(travel(&mut law, -1.0), -0.4);
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
        let mut law = law::<f64>(&before);
        let torque = travel(&mut law, 0.32 / 400.0);
        assert!((torque - 0.32).abs() < 1e-15);
        law.change(&HaywardArmstrong::<f64>::fitted(&after), 1e-4);
        assert!((travel(&mut law, 0.0) - expected).abs() < 1e-15);
        let torque = travel(&mut law, -1e-6);
        let slope = (expected - torque) / 1e-6;
        assert!((slope / after.stiffness_nm_per_rad - 1.0).abs() < 1e-9);
    }
}

/// A joint that reverses at every break (Tk = 0), and the fit's limit α → ∞ (Tk = Ts/2).
#[test]
fn the_point_may_jump_beyond_the_shaft() {
    for kinetic_torque_nm in [0.0, 0.1, 0.2] {
        let contact = Contact {
            kinetic_torque_nm,
            ..contact()
        };
        let torques = run(&mut law::<f64>(&contact), 1e-6, 100_100);
        let least = torques.iter().fold(f64::MAX, |a, b| a.min(*b));
        let restart = 2.0 * kinetic_torque_nm - 0.4;
        let floor = restart.min(4e-4);
        assert!(least >= floor - 1e-12 && least < floor + 4e-4, "{least}");
        let cycle = 2.0 * (0.4 - kinetic_torque_nm) / 400.0;
        assert_eq!(falls(&torques), ((0.1001 - 1e-3) / cycle + 1.0) as usize);
    }
}

#[test]
fn single_precision_counts_the_same_breaks() {
    let contact = contact();
    // 19.88 rad: 1 mrad to the first break, then 0.75 mrad each.
    let double = falls(&run(&mut law::<f64>(&contact), 4.97e-5, 400_000));
    let single = falls(&run(&mut law::<f32>(&contact), 4.97e-5, 400_000));
    assert_eq!(double, 26_506);
    assert!(double.abs_diff(single) <= 1, "{double} {single}");
}

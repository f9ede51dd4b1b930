//! Karnopp's law against the closed forms of the paper's cycle, and its own.

use super::*;
use std::vec::Vec;

fn joint() -> Parameters {
    Parameters::default()
}

fn even<F: Real>(omega: f64, step_s: f64) -> ShaftStep<F> {
    ShaftStep {
        delta_phi_rad: F::from_f64(omega * step_s),
        omega_start_rad_s: F::from_f64(omega),
        omega_end_rad_s: F::from_f64(omega),
    }
}

fn law<F: Real>(omega: f64, step_s: f64) -> Karnopp<F> {
    Karnopp::fitted(&joint(), step_s, F::from_f64(omega)).unwrap()
}

/// Torques of `seconds` at constant speed.
fn torques<F: Real>(omega: f64, step_s: f64, seconds: f64) -> Vec<f64> {
    let (mut law, shaft) = (law::<F>(omega, step_s), even(omega, step_s));
    let steps = (seconds / step_s).round().to_f64().whole();
    (0..steps).map(|_| law.step(&shaft).to_f64()).collect()
}

/// Mean period between the breaks of the first and the last of many cycles, s: a break is the
/// fall from above 0.3 N·m.
fn period_s<F: Real>(omega: f64, step_s: f64) -> f64 {
    let torques = torques::<F>(omega, step_s, 1.0);
    let breaks: Vec<f64> = torques
        .windows(2)
        .zip(0_u32..)
        .filter(|(pair, _)| pair[0] > 0.3 && pair[1] < 0.3)
        .map(|(_, n)| f64::from(n) * step_s)
        .collect();
    let cycles = u32::try_from(breaks.len() - 1).unwrap();
    assert!(cycles > 20, "{cycles}");
    (breaks[breaks.len() - 1] - breaks[0]) / f64::from(cycles)
}

/// A stick from 2Tk − Ts to Ts, then a slip of 2(π − atan(drop/(Ω·√(J·k))))/ωn.
fn known_period_s(omega: f64) -> f64 {
    let p = joint();
    let drop = p.static_torque_nm - p.kinetic_torque_nm;
    let stick = 2.0 * drop / (p.stiffness_nm_per_rad * omega);
    let lag = (drop / (omega * p.impedance_nms_per_rad())).atan();
    stick + 2.0 * (std::f64::consts::PI - lag) / p.natural_rad_s()
}

/// The share of a cycle that late breaks add. A stick breaks t = √(2·J·Dv/(k·Ω)) late, so that
/// the drop D grows by k·Ω·t: sticks last 2·t longer, slips 2·t/(1 + x²) less, x = D/(Ω·√(J·k)).
fn late(omega: f64, step_s: f64) -> f64 {
    let p = joint();
    let leaving = 2.0 * p.inertia_kg_m2 * band_rad_s(&p, step_s);
    let late_s = (leaving / (p.stiffness_nm_per_rad * omega)).sqrt();
    let x = (p.static_torque_nm - p.kinetic_torque_nm) / (omega * p.impedance_nms_per_rad());
    2.0 * late_s * x * x / (1.0 + x * x) / known_period_s(omega)
}

fn off<F: Real>(omega: f64, step_s: f64) -> f64 {
    known_period_s(omega) / period_s::<F>(omega, step_s) - 1.0
}

#[test]
fn cycle_frequency_converges_to_the_closed_form() {
    for omega in [0.1, 0.5, 1.0, 2.0] {
        let steps = [5e-5, 1e-5, 1e-6];
        let errors = steps.map(|step_s| off::<f64>(omega, step_s));
        std::println!("{omega} rad/s, 50, 10 and 1 µs: {errors:.5?}");
        let [coarse, middle, fine] = errors.map(f64::abs);
        assert!(fine < 0.005, "{omega} rad/s: {fine}");
        assert!(middle < 0.6 * coarse && fine < 0.5 * middle, "{errors:?}");
        // Most of it is the band: the frequency is too low by that. Breaks are seen in whole steps.
        for (error, step_s) in errors.iter().zip(steps) {
            let rest = (error + late(omega, step_s)).abs();
            assert!(rest < 0.04 * late(omega, step_s) + 5.0 * step_s, "{rest}");
        }
        let single = off::<f32>(omega, 1e-5);
        assert!(
            (single - errors[1]).abs() < 1e-4,
            "f32: {single} {errors:?}"
        );
    }
}

#[test]
fn torque_is_the_ramp_then_the_static_then_the_kinetic_one() {
    for (omega, step_s) in [(0.5, 5e-5), (1.0, 5e-5), (-1.0, 1e-5), (2.0, 1e-6)] {
        let torques = torques::<f64>(omega, step_s, 0.03);
        let sign = omega.signum();
        let rise = 400.0 * omega * step_s;
        // The ramp k·Ω·t, up to the last step below Ts.
        let ramp = torques
            .iter()
            .take_while(|t| *t * sign < 0.4 - 1e-12)
            .count();
        let known = 0.4 / rise.abs();
        let ends = f64::from(u32::try_from(ramp).unwrap());
        assert!(
            (ends - known).abs() < 1.0 + 1e-9,
            "{ends} steps, not {known}"
        );
        for (n, t) in (1_u32..).zip(&torques[..ramp]) {
            assert!((t - f64::from(n) * rise).abs() < 1e-12, "step {n}: {t}");
        }
        // While the object leaves the band, Ts; then Tk, to the end of the slip.
        let held = torques[ramp..]
            .iter()
            .take_while(|t| **t * sign > 0.4 - 1e-12)
            .count();
        assert!(held > 0);
        let slip = &torques[ramp + held..][..(0.02 / step_s).to_f64().whole().try_into().unwrap()];
        assert!(slip.iter().all(|t| *t == sign * 0.2), "{omega} {step_s}");
        let leaving_s = (2.0 * 0.01 * band_rad_s(&joint(), step_s) / (400.0 * omega.abs())).sqrt();
        let held_s = f64::from(u32::try_from(held).unwrap()) * step_s;
        assert!(
            (held_s - leaving_s).abs() <= 2.0 * step_s,
            "{held_s} {leaving_s}"
        );
    }
}

#[test]
fn a_stick_begins_with_the_torque_of_the_spring() {
    // What is left of w when the band is entered would be up to 0.3 N·m in one step.
    for step_s in [5e-5, 1e-6] {
        let torques = torques::<f64>(1.0, step_s, 0.1);
        let begins = torques
            .windows(2)
            .filter(|pair| pair[0] == 0.2 && pair[1] < 0.2);
        let first: Vec<f64> = begins.map(|pair| pair[1]).collect();
        assert_eq!(first.len(), 3);
        // 2·Tk − Ts = 0, less what the drop grew by, k·Ω·t, and within two steps of the ramp.
        let late_s = (2.0 * 0.01 * band_rad_s(&joint(), step_s) / 400.0).sqrt();
        for torque in first {
            let off = torque + 400.0 * late_s;
            assert!(off.abs() < 2.0 * 400.0 * step_s, "{torque} {off}");
        }
    }
}

#[test]
fn a_velocity_step_within_a_step_is_held_at_most_by_the_static_torque() {
    let torque = |start, end| {
        law::<f64>(0.1, 5e-5).step(&ShaftStep {
            delta_phi_rad: 5e-6,
            omega_start_rad_s: start,
            omega_end_rad_s: end,
        })
    };
    // In the band at the start: J·ΔΩ/h is 20 N·m. A step before it: out of the band, so Tk.
    assert_eq!((torque(0.1, 0.2), torque(0.1, 0.0)), (0.4, -0.4));
    assert_eq!((torque(0.2, 0.2), torque(0.0, 0.0)), (0.2, -0.2));
}

#[test]
fn static_torque_is_never_exceeded_and_mirrors() {
    for step_s in [1e-3, 5e-5, 1e-6] {
        let (there, back) = (
            torques::<f32>(1.3, step_s, 0.2),
            torques::<f32>(-1.3, step_s, 0.2),
        );
        for (t, b) in there.iter().zip(&back) {
            assert!(
                *t <= 0.4 + 1e-8 && *t >= -0.4 - 1e-8 && *t == -*b,
                "{t} {b}"
            );
        }
    }
}

/// Largest errors of angle and torque in 1e5 steps of a tremor that stays within ±Ts.
fn drift<F: Real>() -> (f64, f64) {
    let step_s = 5e-5;
    // 8 Hz, 0.3 mrad, about an angle that goes to 0.5 mrad.
    let rate = 16.0 * std::f64::consts::PI;
    let angle = |t: f64| 5e-4 * (t / 0.5).min(1.0) + 3e-4 * (rate * t).sin();
    let omega = |t: f64| if t < 0.5 { 1e-3 } else { 0.0 } + 3e-4 * rate * (rate * t).cos();
    let mut law = law::<F>(omega(0.0), step_s);
    let (mut off_rad, mut off_nm) = (0.0_f64, 0.0_f64);
    let mut before = omega(0.0);
    for n in 0..100_000_u32 {
        let (t0, t1) = (f64::from(n) * step_s, f64::from(n + 1) * step_s);
        let torque = law.step(&ShaftStep {
            delta_phi_rad: F::from_f64(angle(t1) - angle(t0)),
            omega_start_rad_s: F::from_f64(before),
            omega_end_rad_s: F::from_f64(omega(t1)),
        });
        let known = 400.0 * angle(t1) + 0.01 * (omega(t1) - before) / step_s;
        before = omega(t1);
        off_rad = off_rad.max((law.theta.value().to_f64() - angle(t1)).abs());
        off_nm = off_nm.max((torque.to_f64() - known).abs());
    }
    (off_rad, off_nm)
}

#[test]
fn a_stick_does_not_drift() {
    let (off_rad, off_nm) = drift::<f64>();
    std::println!("f64: {off_rad:.1e} rad, {off_nm:.1e} N·m");
    assert!(off_rad < 1e-15 && off_nm < 1e-12, "{off_rad} {off_nm}");
    let (off_rad, off_nm) = drift::<f32>();
    std::println!("f32: {off_rad:.1e} rad, {off_nm:.1e} N·m");
    // A velocity of 15 mrad/s is rounded by 5e-10 rad/s, and J/h is 200.
    assert!(off_rad < 1e-9 && off_nm < 5e-7, "{off_rad} {off_nm}");
}

#[test]
fn at_rest_every_swing_comes_to_stick_and_stays() {
    // The shaft stops in the middle of a slip: the object swings, each half less by 2·Tk.
    for step_s in [1e-3, 5e-5, 1e-6] {
        for (ts, tk) in [(0.4, 0.2), (0.4, 0.4), (0.4, 0.01)] {
            let joint = Parameters {
                static_torque_nm: ts,
                kinetic_torque_nm: tk,
                ..joint()
            };
            let mut law = Karnopp::<f64>::fitted(&joint, step_s, 1.0).unwrap();
            for _ in 0..(0.01 / step_s).whole() {
                law.step(&even(1.0, step_s));
            }
            for _ in 0..(3.0 / step_s).whole() {
                law.step(&even(0.0, step_s));
            }
            let torque = law.step(&even(0.0, step_s));
            assert_eq!(law.theta_dot_rad_s, 0.0, "{step_s} {ts} {tk}");
            assert!((torque - 400.0 * law.theta.value()).abs() < 1e-12);
        }
    }
}

#[test]
fn a_stick_feels_inertia_and_damping() {
    let joint = Parameters {
        damping_nms_per_rad: 0.3,
        ..joint()
    };
    let mut law = Karnopp::<f64>::fitted(&joint, 5e-5, 0.1).unwrap();
    let torque = law.step(&ShaftStep {
        delta_phi_rad: 5e-6,
        omega_start_rad_s: 0.1,
        omega_end_rad_s: 0.1005,
    });
    // J·10 rad/s² + c·Ω + k·θ.
    assert!(
        (torque - (0.1 + 0.030_15 + 0.002)).abs() < 1e-12,
        "{torque}"
    );
}

#[test]
fn a_change_keeps_the_state() {
    let stiffer = Parameters {
        stiffness_nm_per_rad: 800.0,
        static_torque_nm: 2.0,
        ..joint()
    };
    // 0.1 N·m in stick.
    let mut law = law::<f64>(0.5, 5e-5);
    for _ in 0..10 {
        law.step(&even(0.5, 5e-5));
    }
    let (theta, velocity) = (law.theta, law.theta_dot_rad_s);
    law.change(&stiffer, 1e-5).unwrap();
    assert_eq!((law.theta, law.theta_dot_rad_s), (theta, velocity));
    let torque = law.step(&even(0.5, 1e-5));
    assert!((torque - 800.0 * (2.5e-4 + 5e-6)).abs() < 1e-12, "{torque}");
    // What is invalid is refused, and changes nothing.
    let error = Parameters {
        kinetic_torque_nm: 3.0,
        ..stiffer
    };
    assert!(law.change(&error, 5e-5).is_err() && law.change(&joint(), 0.0).is_err());
    let torque = law.step(&even(0.5, 1e-5));
    assert!((torque - 800.0 * (2.5e-4 + 1e-5)).abs() < 1e-12, "{torque}");
}

//! Motions, and a second way to integrate, for the tests of laws.

use super::{Contact, FrictionLaw};
use crepitus_model::{Parameters, Real, ShaftStep};
use std::vec::Vec;

/// A step of the control loop, s.
pub(super) const STEP_S: f64 = 5e-5;

/// So slow that no Stribeck curve has dropped, rad/s.
pub(super) const SLOW_RAD_S: f64 = 1e-9;

/// A contact as that of the paper's joint, with a vs of 10 mrad/s and `damping`.
pub(super) fn contact(damping_nms_per_rad: f64) -> Contact {
    Contact {
        damping_nms_per_rad,
        stribeck_rad_s: 0.01,
        ..direct()
    }
}

/// The default joint's contact to ground.
pub(super) fn direct() -> Contact {
    Contact::direct(&Parameters::default())
}

/// The default joint's contact to its object.
pub(super) fn on_object() -> Contact {
    Contact::on_object(&Parameters::default()).0
}

/// The same with a vs of 1 mrad/s, a hundredth of the swing.
pub(super) fn sudden() -> Contact {
    Contact {
        stribeck_rad_s: 1e-3,
        ..on_object()
    }
}

/// The contact to ground with Ts = Tk = 0.4 N·m: no law on it depends on the rate.
pub(super) fn rate_independent() -> Contact {
    Contact::direct(&Parameters {
        kinetic_torque_nm: 0.4,
        ..Parameters::default()
    })
}

/// The law on a contact.
pub(super) fn on<F: Real, L: FrictionLaw<F>>(contact: &Contact, step_s: f64) -> L {
    L::new(&L::fitted(contact), step_s)
}

/// A step of `travel_rad` at a velocity.
pub(super) fn at<F: Real>(travel_rad: f64, omega_rad_s: f64) -> ShaftStep<F> {
    ShaftStep {
        delta_phi_rad: F::from_f64(travel_rad),
        omega_start_rad_s: F::from_f64(omega_rad_s),
        omega_end_rad_s: F::from_f64(omega_rad_s),
    }
}

/// One step of a constant velocity.
pub(super) fn steady<F: Real, L: FrictionLaw<F>>(law: &mut L, omega: f64, step_s: f64) -> f64 {
    law.step(&at(omega * step_s, omega)).to_f64()
}

/// One step of this travel, as slow as can be.
pub(super) fn creep<F: Real, L: FrictionLaw<F>>(law: &mut L, travel_rad: f64) -> f64 {
    law.step(&at(travel_rad, 0.0)).to_f64()
}

/// The torque after `count` steps at a constant velocity.
pub(super) fn run<F: Real, L: FrictionLaw<F>>(law: &mut L, omega_rad_s: f64, count: u32) -> f64 {
    (0..count).fold(f64::NAN, |_, _| steady(law, omega_rad_s, STEP_S))
}

/// The torque after a slow travel in equal steps.
pub(super) fn travel<L: FrictionLaw<f64>>(law: &mut L, travel_rad: f64, count: u32) -> f64 {
    let one = at(
        travel_rad / f64::from(count),
        SLOW_RAD_S.copysign(travel_rad),
    );
    (0..count).fold(f64::NAN, |_, _| law.step(&one))
}

/// The motion φ = A·(1 − cos(w·t)) from step `n` on: travel and velocities.
pub(super) fn swing<F: Real>(amplitude_rad: f64, rad_s: f64, n: u32, step_s: f64) -> ShaftStep<F> {
    let start = rad_s * step_s * f64::from(n);
    let end = rad_s * step_s * f64::from(n + 1);
    let (sin_start, cos_start) = Real::sin_cos(start);
    let (sin_end, cos_end) = Real::sin_cos(end);
    ShaftStep {
        delta_phi_rad: F::from_f64(amplitude_rad * (cos_start - cos_end)),
        omega_start_rad_s: F::from_f64(amplitude_rad * rad_s * sin_start),
        omega_end_rad_s: F::from_f64(amplitude_rad * rad_s * sin_end),
    }
}

/// Velocity and angle of a motion to and fro that begins with its full velocity, t in s.
fn to_and_fro(t: f64) -> (f64, f64) {
    let (amplitude, rate) = (8e-4, 40.0);
    let (sin, cos) = (rate * t).sin_cos();
    (amplitude * rate * cos, amplitude * sin)
}

/// Runs a law over 0.3 s of [`to_and_fro`] in `steps`, with the torque after each.
pub(super) fn swung<L: FrictionLaw<f64>>(law: &mut L, steps: i32) -> Vec<f64> {
    let at = |i: i32| to_and_fro(0.3 * f64::from(i) / f64::from(steps));
    let one = |i: i32| {
        let ((start, from), (end, to)) = (at(i), at(i + 1));
        law.step(&ShaftStep {
            delta_phi_rad: to - from,
            omega_start_rad_s: start,
            omega_end_rad_s: end,
        })
    };
    (0..steps).map(one).collect()
}

/// A step h of the classical method of Runge and Kutta for ẏ = rate(t, y), from the time t.
pub(super) fn runge_kutta_step<const N: usize>(
    t: f64,
    h: f64,
    y: [f64; N],
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let plus = |k: [f64; N], by: f64| core::array::from_fn(|n| y[n] + by * k[n]);
    let k1 = rate(t, y);
    let k2 = rate(t + 0.5 * h, plus(k1, 0.5 * h));
    let k3 = rate(t + 0.5 * h, plus(k2, 0.5 * h));
    let k4 = rate(t + h, plus(k3, h));
    core::array::from_fn(|n| y[n] + h / 6.0 * (k1[n] + 2.0 * (k2[n] + k3[n]) + k4[n]))
}

/// The same over 0.3 s of [`to_and_fro`], with `every`·`steps` steps of ẏ = rate(v, y): (v, y)
/// after every so many.
pub(super) fn runge_kutta<const N: usize>(
    steps: i32,
    every: i32,
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
) -> Vec<(f64, [f64; N])> {
    let h = 0.3 / f64::from(steps * every);
    let mut y = [0.0; N];
    let mut result = Vec::new();
    for i in 0..steps * every {
        let t = f64::from(i) * h;
        y = runge_kutta_step(t, h, y, |t, y| rate(to_and_fro(t).0, y));
        if (i + 1) % every == 0 {
            result.push((to_and_fro(t + h).0, y));
        }
    }
    result
}

/// Largest difference of two curves.
pub(super) fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let gap = |(a, b): (&f64, &f64)| (a - b).abs();
    a.iter().zip(b).map(gap).fold(0.0, f64::max)
}

/// Travel in each of `cycles` of a load between two torques, neither of which breaks away.
pub(super) fn drift<L: FrictionLaw<f64>>(law: &mut L, low: f64, high: f64, cycles: i32) -> f64 {
    let travel = 1e-8;
    let (mut steps, mut torque) = (0, 0.0);
    let mut load = |wanted: f64| {
        let before = steps;
        while torque < wanted {
            torque = creep(law, travel);
            steps += 1;
            assert!(steps - before < 1_000_000, "the load is borne nowhere");
        }
        while torque > wanted {
            torque = creep(law, -travel);
            steps -= 1;
            assert!(before - steps < 1_000_000, "the load is borne nowhere");
        }
        steps
    };
    let start = load(low);
    let mut end = start;
    for _ in 0..cycles {
        load(high);
        end = load(low);
    }
    f64::from(end - start) * travel / f64::from(cycles)
}

/// The same for bristles that yield towards `level`, in closed form.
pub(super) fn drift_of_bristles(stiffness: f64, level: f64, low: f64, high: f64) -> f64 {
    let forth = ((level - low) / (level - high)).ln();
    let back = ((level + high) / (level + low)).ln();
    level / stiffness * (forth - back)
}

/// Returns whether a law bears contacts without friction, without its kinetic part, and without a
/// drop.
pub(super) fn bears_extremes<F: Real, L: FrictionLaw<F>>() -> bool {
    [(0.0, 0.0), (0.3, 0.0), (0.3, 0.3), (1e6, 1e6)].iter().all(
        |&(static_torque_nm, kinetic_torque_nm)| {
            let joint = Parameters {
                static_torque_nm,
                kinetic_torque_nm,
                ..Parameters::default()
            };
            [Contact::direct(&joint), Contact::on_object(&joint).0]
                .iter()
                .all(|contact| {
                    let mut law: L = on(contact, STEP_S);
                    (0..5000).all(|n| {
                        let torque_nm = law.step(&swing(0.05, 400.0, n, STEP_S)).to_f64();
                        torque_nm.abs() <= 1.001 * (static_torque_nm + kinetic_torque_nm) + 1e-9
                    })
                })
        },
    )
}

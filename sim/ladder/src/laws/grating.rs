//! Tests of what grates: every law on an object, beside the joint.

use super::motion::{STEP_S, at};
use super::{ENTRIES, Entry, LawVisitor, Mounted};
use crepitus_model::{Parameters, Real};
use std::vec::Vec;

/// The entry of this name.
fn named(name: &str) -> &'static Entry {
    ENTRIES.iter().find(|entry| entry.name == name).unwrap()
}

/// Two seconds at a constant velocity, after two seconds of the same.
#[derive(Clone, Copy, Debug)]
struct Grate {
    joint: Parameters,
    omega_rad_s: f64,
    step_s: f64,
}

/// Grating.
#[derive(Clone, Copy, Debug)]
struct Grating {
    /// Breaks a second, from the first to the last. A break is a fall by half of Ts − Tk about
    /// Tk: below the low torque, after the high one.
    hz: f64,
    least_nm: f64,
    most_nm: f64,
    mean_nm: f64,
}

impl Grate {
    /// Grating of the default joint's entry of this name.
    fn of<F: Real>(name: &str, omega_rad_s: f64, step_s: f64) -> Grating {
        Self {
            joint: Parameters::default(),
            omega_rad_s,
            step_s,
        }
        .on::<F>(name)
    }

    /// Grating of the entry of this name.
    fn on<F: Real>(self, name: &str) -> Grating {
        let omega = F::from_f64(self.omega_rad_s);
        let visited = named(name).with(&self.joint, self.step_s, omega, self);
        visited.unwrap()
    }
}

impl<F: Real> LawVisitor<F> for Grate {
    type Output = Grating;

    fn visit<M: Mounted<F>>(self, mut law: M) -> Grating {
        let steps: u32 = (2.0 / self.step_s).whole().try_into().unwrap();
        let half_nm = 0.25 * (self.joint.static_torque_nm - self.joint.kinetic_torque_nm);
        let shaft = at(self.omega_rad_s * self.step_s, self.omega_rad_s);
        let mut step = || law.step(&shaft).to_f64();
        for _ in 0..steps {
            step();
        }
        let (mut is_high, mut breaks, mut ends) = (false, 0, None);
        let (mut least_nm, mut most_nm, mut sum_nm) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for n in 0..steps {
            let torque_nm = step();
            least_nm = least_nm.min(torque_nm);
            most_nm = most_nm.max(torque_nm);
            sum_nm += torque_nm;
            let above_nm = torque_nm - self.joint.kinetic_torque_nm;
            if is_high && above_nm < -half_nm {
                breaks += 1;
                ends = Some((ends.map_or(n, |(first, _)| first), n));
            }
            is_high = above_nm > half_nm || (is_high && above_nm >= -half_nm);
        }
        let hz = match ends {
            Some((first, last)) if first < last => {
                f64::from(breaks - 1) / (f64::from(last - first) * self.step_s)
            }
            _ => 0.0,
        };
        Grating {
            hz,
            least_nm,
            most_nm,
            mean_nm: sum_nm / f64::from(steps),
        }
    }
}

/// Half the swing of the object's velocity, the swing, and up to twenty times that, rad/s.
const OMEGAS: [f64; 6] = [0.05, 0.1, 0.3, 0.5, 0.988, 2.0];

/// Names of what grates on an object in steps of 50 µs.
fn grates() -> Vec<&'static str> {
    let names = ENTRIES.iter().filter(|entry| entry.is_on_object());
    names
        .map(|entry| entry.name)
        .filter(|name| *name != "lugre-object")
        .collect()
}

/// Frequencies in steps of 50 µs, at [`OMEGAS`].
fn frequencies<F: Real>(name: &str) -> [f64; 6] {
    OMEGAS.map(|omega| Grate::of::<F>(name, omega, STEP_S).hz)
}

#[test]
fn every_law_on_an_object_grates_as_fast_as_the_joint() {
    let joint = frequencies::<f64>("frozen");
    for name in grates() {
        let (double, single) = (frequencies::<f64>(name), frequencies::<f32>(name));
        std::println!("{name:26} {double:6.2?}");
        // Below the swing, what the torque does around the break is part of the cycle.
        for ((hz, single_hz), (joint_hz, share)) in double.into_iter().zip(single).zip(
            joint
                .into_iter()
                .zip([0.13, 0.09, 0.02, 0.007, 0.002, 0.001]),
        ) {
            let off = hz / joint_hz - 1.0;
            assert!(off.abs() < share, "{name}: {double:?} {joint:?}");
            assert!(
                (single_hz / hz - 1.0).abs() < 1e-3,
                "{name}: {single:?} {double:?}"
            );
        }
    }
}

#[test]
fn a_function_of_velocity_alternates_in_steps_beyond_its_limit() {
    for name in ["tanh-object", "band-object"] {
        assert!(Grate::of::<f64>(name, 0.3, 1.4e-4).hz < 32.0);
        assert!(Grate::of::<f64>(name, 0.3, 2e-4).hz > 100.0);
    }
}

#[test]
fn shorter_steps_grate_as_fast() {
    for name in grates() {
        for omega in [0.1, 0.988] {
            let coarse = Grate::of::<f64>(name, omega, STEP_S);
            let fine = Grate::of::<f64>(name, omega, 5e-6);
            let share = if name == "karnopp" { 0.02 } else { 0.002 };
            assert!((coarse.hz / fine.hz - 1.0).abs() < share, "{name} {omega}");
        }
    }
    // Explicit Euler diverges beyond σ0·|v|·h = 2·g.
    for (omega, step_s, grates) in [
        (0.05, STEP_S, true),
        (0.3, STEP_S, false),
        (0.988, 5e-6, true),
    ] {
        let joint = Grate::of::<f64>("frozen", omega, step_s);
        let found = Grate::of::<f64>("lugre-object", omega, step_s);
        let is_close = (found.hz / joint.hz - 1.0).abs() < 0.13;
        assert_eq!(is_close, grates, "{omega} {step_s}: {found:?}");
    }
}

#[test]
fn on_ground_a_travel_alone_grates_and_only_in_one_law() {
    for entry in ENTRIES.iter().filter(|entry| !entry.is_on_object()) {
        let found = Grate::of::<f64>(entry.name, 0.3, STEP_S);
        if entry.name == "hayward-armstrong" {
            // Ω·k/(2·(Ts − Tk)).
            assert!((found.hz - 300.0).abs() < 0.1, "{found:?}");
        } else {
            assert!(
                found.most_nm - found.least_nm < 1e-9,
                "{}: {found:?}",
                entry.name
            );
            assert!(
                (found.mean_nm - 0.2).abs() < 1e-9,
                "{}: {found:?}",
                entry.name
            );
        }
    }
}

//! The stage of the vibration actuator: what its precision and its step cost of the
//! voltage, and what it costs in time.
//!
//! ```text
//! coarse at 1 rad/s, a sixteenth of a tick ─┬─> law, f64, every one ──────────────┐
//!                                            └─> law × precision × step, each ─────┴─> error from 15 to 500 Hz
//! ```
//!
//! Torque between samples is unknown to a step: a jump is late by a part of it, which is
//! all of the error in f64.

use crate::watcher::{StudyError, Watcher};
use crepitus_ladder::loops::Loops;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::vibration_actuator::{
    VibrationActuator, VibrationActuatorSettings,
};
use crepitus_model::render::effects::{DeviceEffect, Timing};
use crepitus_model::render::position::Sensing;
use crepitus_model::solver::Solver;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Real, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip,
};
use crepitus_pages::table::Table;
use crepitus_pages::table::show::{fixed, microseconds, scientific};
use crepitus_plant::spectrum::cross::Cross;
use crepitus_scene::cpu_time;
use crepitus_scene::scene::Precision;
use serde::Serialize;

/// Steps, as multiples of the finest.
const STRIDES: [usize; 4] = [4, 16, 32, 64];

/// The finest step, s: a sixteenth of a tick of the device.
const FINEST_S: f64 = 5e-5 / 16.0;

/// Speed of the joint, rad/s, and length of the run, finest steps.
const OMEGA_RAD_S: f64 = 1.0;
const STEPS: usize = 640_000;

/// The band that matters, Hz.
const BAND_HZ: (f64, f64) = (15.0, 500.0);

/// Ticks of one timing.
const TIMED: usize = 20_000;

/// The stage in a precision at a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ActuatorPoint {
    /// The precision.
    pub precision: &'static str,
    /// The step, s.
    pub step_s: f64,
    /// Error of the voltage from 15 to 500 Hz, as a share of it.
    pub error: f64,
    /// Difference from f64 at the same step, likewise.
    pub rounding: f64,
    /// CPU time of a tick over that of a step of crepitus, `exact-events` under `frozen`,
    /// in the same precision.
    pub time_ratio: f64,
}

/// Table for people, a row a step and precision.
pub fn actuator_table(points: &[ActuatorPoint]) -> Table<'_, ActuatorPoint> {
    Table::of(points)
        .people("step", |point| point.step_s)
        .rounded(microseconds)
        .left()
        .people("precision", |point| point.precision)
        .people("error", |point| point.error)
        .rounded(scientific)
        .people("rounding", |point| point.rounding)
        .rounded(scientific)
        .people("× crepitus", |point| point.time_ratio)
        .rounded(fixed::<1>)
}

/// Studies the stage, by falling rate and precision.
///
/// # Errors
/// Error of the watcher.
pub fn points(repeats: usize, watcher: &mut dyn Watcher) -> Result<Vec<ActuatorPoint>, StudyError> {
    let torque = torque_nm(FINEST_S, STEPS)?;
    let exact = voltages::<f64>(&torque, 1)?;
    let ratios = [ratio::<f64>(repeats)?, ratio::<f32>(repeats)?];
    let mut points = Vec::new();
    for (done, stride) in STRIDES.into_iter().enumerate() {
        let double = voltages::<f64>(&torque, stride)?;
        let single = voltages::<f32>(&torque, stride)?;
        let step_s = FINEST_S * whole(stride);
        let of_exact: Vec<f64> = exact.iter().copied().step_by(stride).collect();
        for (precision, volts, time_ratio) in [
            (Precision::F64, &double, ratios[0]),
            (Precision::F32, &single, ratios[1]),
        ] {
            points.push(ActuatorPoint {
                precision: precision.name(),
                step_s,
                error: off(&of_exact, volts, step_s),
                rounding: off(&double, volts, step_s),
                time_ratio,
            });
        }
        watcher.progress(whole(done + 1) / whole(STRIDES.len()))?;
    }
    Ok(points)
}

/// The joint's torque at the end of each step of so many, N·m.
fn torque_nm(step_s: f64, steps: usize) -> Result<Vec<f64>, SettingsError> {
    let coefficients = StepCoefficients::new(&Settings::default().validate()?, step_s)?;
    let mut joint: Frozen<f64, ExactEvents> = Frozen::new(coefficients, OMEGA_RAD_S);
    let step = steady(step_s);
    Ok((0..steps)
        .map(|_| {
            joint.step(&step, |_| {});
            joint.torque_nm()
        })
        .collect())
}

fn steady<F: Real>(step_s: f64) -> ShaftStep<F> {
    let omega = F::from_f64(OMEGA_RAD_S);
    ShaftStep {
        delta_phi_rad: F::from_f64(OMEGA_RAD_S * step_s),
        omega_start_rad_s: omega,
        omega_end_rad_s: omega,
    }
}

fn law<F: Real>(step_s: f64) -> Result<VibrationActuator<F>, SettingsError> {
    let timing = Timing {
        step_s,
        delay_ticks: 1,
        sensing: Sensing::IDEAL,
    };
    let settings = VibrationActuatorSettings::defaults();
    Ok(VibrationActuator::new(VibrationActuator::coefficients(
        &settings, &timing,
    )?))
}

/// The voltages of the law that gets every so manyth torque.
fn voltages<F: Real>(torque: &[f64], stride: usize) -> Result<Vec<f64>, SettingsError> {
    let mut law = law::<F>(FINEST_S * whole(stride))?;
    let given = torque.iter().step_by(stride);
    Ok(given
        .map(|nm| law.tick(F::from_f64(*nm), true).to_f64())
        .collect())
}

/// Root mean square of the difference in the band, as a share of the signal's.
fn off(exact: &[f64], found: &[f64], step_s: f64) -> f64 {
    let difference: Vec<f64> = exact.iter().zip(found).map(|(a, b)| a - b).collect();
    let (low, high) = BAND_HZ;
    // The gain has faded in by then.
    let skip = exact.len() / 4;
    let cross = exact
        .get(skip..)
        .zip(difference.get(skip..))
        .and_then(|(exact, off)| Cross::new(exact, off, step_s));
    cross.map_or(f64::NAN, |cross| {
        let (signal, off) = cross.rms(low, high, |_| 1.0);
        off / signal
    })
}

/// Time of a tick over that of a step of crepitus: the median of repeats, in turn.
fn ratio<F: Loops>(repeats: usize) -> Result<f64, SettingsError> {
    let (step_s, omega) = (5e-5, F::from_f64(OMEGA_RAD_S));
    let settings = Settings::default().validate()?;
    let mut law = law::<F>(step_s)?;
    let steps = vec![steady::<F>(step_s); TIMED];
    let torques_nm: Vec<F> = torque_nm(step_s, TIMED)?
        .into_iter()
        .map(F::from_f64)
        .collect();
    let mut ratios: Vec<f64> = Vec::new();
    F::joint(&settings, Solver::ExactEvents, step_s, omega, &mut |step| {
        for _ in 0..repeats.max(3) {
            let begun = cpu_time::now();
            step(&steps);
            let of_joint = cpu_time::since(begun).as_secs_f64();
            let begun = cpu_time::now();
            F::actuator(&mut law, &torques_nm);
            ratios.push(cpu_time::since(begun).as_secs_f64() / of_joint);
        }
    })?;
    ratios.sort_by(f64::total_cmp);
    Ok(ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN))
}

fn whole(n: usize) -> f64 {
    f64::from_whole(u64::try_from(n).unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_far_below_what_the_step_costs() {
        let torque = torque_nm(FINEST_S, STEPS).unwrap();
        let exact = voltages::<f64>(&torque, 1).unwrap();
        let mut last = 0.0;
        for stride in STRIDES {
            let step_s = FINEST_S * whole(stride);
            let double = voltages::<f64>(&torque, stride).unwrap();
            let single = voltages::<f32>(&torque, stride).unwrap();
            let of_exact: Vec<f64> = exact.iter().copied().step_by(stride).collect();
            let error = off(&of_exact, &double, step_s);
            let rounding = off(&double, &single, step_s);
            assert!(error > last && error < 0.2, "{step_s}: {error}");
            assert!(rounding < 4e-5, "{step_s}: {rounding}");
            last = error;
        }
    }
}

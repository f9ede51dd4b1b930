//! The tasks, a file each.

pub mod break_away;
pub mod changes;
pub mod creep;
pub mod encoder;
pub mod grating;
pub mod hand;
pub mod hour;
pub mod knee;
pub mod lost_samples;
pub mod presliding;
pub mod reversal;
#[cfg(test)]
mod tests;
pub mod zero_speed;

use super::runner::{Pose, Runner, between};
use super::task::Task;
use crepitus_model::{Parameters, Real, ShaftStep};
use std::f64::consts::TAU;

/// Every task.
pub const TASKS: &[&dyn Task] = &[
    &grating::Grate,
    &knee::Knee,
    &encoder::Encode,
    &lost_samples::Lose,
    &zero_speed::Pause,
    &presliding::Preslide,
    &creep::Creep,
    &break_away::BreakAway,
    &reversal::Reverse,
    &hand::Rest,
    &changes::Change,
    &hour::Hour,
];

/// Velocity at which the steady tasks drag the shaft, rad/s: no whole number of ticks in a cycle.
pub const DRAG_RAD_S: f64 = 0.988;

/// A law without a cycle.
const NO_CYCLES: &str = "does not grate: fewer than two cycles";

/// Angle at which our joint breaks from rest, rad.
fn break_angle_rad(joint: &Parameters) -> f64 {
    joint.static_torque_nm / joint.stiffness_nm_per_rad
}

/// Steps of one cycle of φ = a·sin(2π·f·t), of which a whole number of ticks is a cycle.
fn tremor(runner: &Runner<'_>, amplitude_rad: f64, frequency_hz: f64) -> Vec<ShaftStep<f64>> {
    let count = (runner.rate_hz() / frequency_hz).round().whole();
    let pose = |n: u64| -> Pose {
        let angle = TAU * f64::from_whole(n % count) / f64::from_whole(count);
        (
            amplitude_rad * angle.sin(),
            amplitude_rad * TAU * frequency_hz * angle.cos(),
        )
    };
    (0..count).map(|n| between(pose(n), pose(n + 1))).collect()
}

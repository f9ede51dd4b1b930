//! One number of one law on one joint.

use super::task::{Demand, Quantity, Reading, Use};
use serde::Serialize;

/// A row of the leaderboard.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the law.
    pub law: &'static str,
    /// Name of the joint.
    pub joint: &'static str,
    /// Name of the task.
    pub task: &'static str,
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Use that it is needed for.
    pub of: Use,
    /// Known number.
    pub demanded: f64,
    /// Size of an error that counts as 1.
    pub scale: f64,
    /// Number of the law in f32 at the device's tick.
    pub value: Option<f64>,
    /// Number of the law in f64 at the finest step.
    pub converged: Option<f64>,
    /// Distance of the last two refinements; `None` if there was one only.
    pub refinement: Option<f64>,
    /// Whether that is at most [`SETTLED`] of the scale, or the task needs one refinement only.
    pub is_settled: bool,
    /// Steps in a tick at the finest.
    pub parts: u32,
    /// converged − demanded; 0 where the demand is a least value, and exceeded.
    pub model_error: Option<f64>,
    /// value − converged.
    pub numerical_error: Option<f64>,
    /// |value − demanded|/scale, likewise.
    pub relative_error: Option<f64>,
    /// Reason why the law cannot do it at the device's tick.
    pub failed: Option<&'static str>,
    /// Reason why the law cannot do it even converged.
    pub converged_failed: Option<&'static str>,
}

/// Readings of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct Readings {
    /// At the device's tick.
    pub value: Reading,
    /// At the finest step, if the law was refined.
    pub converged: Option<Reading>,
    /// At the second finest.
    pub before: Option<Reading>,
    /// Steps in a tick at the finest.
    pub parts: u32,
}

/// Distance of two refinements, in shares of the scale, within which a law has converged.
pub const SETTLED: f64 = 0.01;

/// Returns whether two refinements agree: within [`SETTLED`] of the scale, or both fail.
pub fn is_settled(demand: &Demand, last: &Reading, before: &Reading) -> bool {
    match (last.value, before.value) {
        (Some(last), Some(before)) => (last - before).abs() <= SETTLED * demand.scale,
        (None, None) => true,
        _ => false,
    }
}

impl Row {
    /// Of a law on a joint.
    pub fn new(
        [law, joint, task]: [&'static str; 3],
        quantity: &Quantity,
        demand: Demand,
        readings: &Readings,
    ) -> Self {
        let value = readings.value.value;
        let converged = readings.converged.and_then(|reading| reading.value);
        let between = |a: Option<f64>, b: Option<f64>| Some(a? - b?);
        let before = readings.before.and_then(|reading| reading.value);
        Self {
            law,
            joint,
            task,
            quantity: quantity.name,
            unit: quantity.unit,
            of: quantity.of,
            demanded: demand.value,
            scale: demand.scale,
            value,
            converged,
            refinement: between(converged, before).map(f64::abs),
            is_settled: match (&readings.converged, &readings.before) {
                (Some(last), Some(before)) => is_settled(&demand, last, before),
                // The task says why it needs no second one.
                (Some(_), None) => true,
                _ => false,
            },
            parts: readings.parts,
            model_error: converged.map(|converged| demand.error(converged)),
            numerical_error: between(value, converged),
            relative_error: value.map(|value| demand.error(value).abs() / demand.scale),
            failed: readings.value.failed,
            converged_failed: readings.converged.and_then(|reading| reading.failed),
        }
    }

    /// The relative error, infinite where the law cannot do it.
    pub fn error_or_failed(&self) -> f64 {
        match (self.failed, self.relative_error) {
            (None, Some(error)) => error,
            _ => f64::INFINITY,
        }
    }
}

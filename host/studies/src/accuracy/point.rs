//! One point of a work-precision diagram: one solver at one step on one scene.

use crate::accuracy::input::Input;
use serde::Serialize;

/// A measured point. Errors are against the event-driven reference, over
/// events matched one to one; see [`matching`](crate::matching) and
/// [`event_errors`](crate::event_errors) for the definitions. Field names are the columns of
/// `points.csv`, in this order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Name of the study's scene, such as `constant-0.988` or `hand-sine`.
    pub scene: String,
    /// Convention of the stick-slip object.
    pub convention: &'static str,
    /// Knowledge of the shaft, `exact` or `encoder`: see [`input`](crate::accuracy::input).
    pub input: &'static str,
    /// The rung of the ladder.
    pub solver: &'static str,
    /// `f32` or `f64`.
    pub precision: &'static str,
    /// Step, s.
    pub step_s: f64,
    /// Events that the solver found.
    pub events: u64,
    /// Events of the reference.
    pub events_true: u64,
    /// Interior events of either side without a partner: a curve leaves such a
    /// point out.
    pub unmatched: u64,
    /// Worst error of an event's time, s.
    pub max_event_error_s: f64,
    /// Root mean square of the event-time errors, s.
    pub rms_event_error_s: f64,
    /// Worst error of the time between neighbouring events, s.
    pub max_interval_error_s: f64,
    /// Relative error of the cycle frequency; NaN without a complete cycle.
    pub frequency_error_rel: f64,
    /// Root mean square error of the torque held for a step, over continuous
    /// time, N·m; see [`held_torque`](crate::accuracy::held_torque).
    pub rms_held_torque_error_nm: f64,
    /// Largest error of the held torque at any time, N·m.
    pub max_held_torque_error_nm: f64,
    /// The least root mean square error that any torque held for a step can
    /// have here, N·m.
    pub held_floor_nm: f64,
    /// Root mean square torque error at the ends of steps, N·m.
    pub rms_tick_torque_error_nm: f64,
    /// Largest torque error at the end of a step, N·m.
    pub max_tick_torque_error_nm: f64,
    /// Time in slips in which the shaft was behind the object, s. Under
    /// `paper` and `physical` such a slip has missed its end; under
    /// `frozen` it may happen when the hand slows.
    pub behind_s: f64,
    /// Energy that friction supplied in that time, J.
    pub behind_j: f64,
    /// CPU time of the host per step, ns: median of interleaved repeats.
    pub ns_per_step: f64,
    /// First quartile of the repeats, ns.
    pub ns_per_step_q1: f64,
    /// Third quartile of the repeats, ns.
    pub ns_per_step_q3: f64,
    /// CPU time of the host per simulated second, µs.
    pub us_per_simulated_s: f64,
    /// Spread of the repeats: (third quartile − first quartile)/median.
    pub time_spread: f64,
    /// Mean cycles of a step on the target, modelled; NaN if not measured.
    pub cycles_per_step: f64,
    /// Most cycles of a step in this scene, as far as it was run; NaN likewise.
    pub worst_cycles: f64,
    /// Mean instructions of a step on the target; NaN likewise.
    pub instructions_per_step: f64,
    /// Mean instructions of a step on the host; NaN if not counted.
    pub host_instructions_per_step: f64,
}

impl Point {
    /// Returns whether the rung had the true motion, and not the device's view of it.
    pub fn is_exact(&self) -> bool {
        self.input == Input::Exact.name()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An example point of precision `f32` with small errors.
    pub(crate) fn point(solver: &'static str, step_s: f64) -> Point {
        Point {
            scene: "constant-1".to_owned(),
            convention: "frozen",
            input: "exact",
            solver,
            precision: "f32",
            step_s,
            events: 100,
            events_true: 100,
            unmatched: 0,
            max_event_error_s: 1e-5,
            rms_event_error_s: 5e-6,
            max_interval_error_s: 1e-5,
            frequency_error_rel: 1e-6,
            rms_held_torque_error_nm: 1e-4,
            max_held_torque_error_nm: 1e-2,
            held_floor_nm: 5e-5,
            rms_tick_torque_error_nm: 1e-5,
            max_tick_torque_error_nm: 1e-3,
            behind_s: 0.0,
            behind_j: 0.0,
            ns_per_step: 4.0,
            ns_per_step_q1: 3.98,
            ns_per_step_q3: 4.02,
            us_per_simulated_s: 4e-3 / step_s,
            time_spread: 0.01,
            cycles_per_step: f64::NAN,
            worst_cycles: f64::NAN,
            instructions_per_step: f64::NAN,
            host_instructions_per_step: f64::NAN,
        }
    }
}

//! One point of a work-precision diagram: one solver at one step on one scene.

use serde::Serialize;

/// A measured point. Errors are against the event-driven reference, over
/// interior events matched one to one. Field names are the columns of
/// `points.csv`, in this order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Name of the study's scene, such as `constant-0.988` or `hand-sine`.
    pub scene: String,
    /// Convention of the stick-slip object.
    pub convention: &'static str,
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
    /// Root mean square torque error at the ends of steps, N·m.
    pub rms_torque_error_nm: f64,
    /// Largest torque error at the end of a step, N·m.
    pub max_torque_error_nm: f64,
    /// Host time per step, ns: median of interleaved repeats.
    pub ns_per_step: f64,
    /// Host time per simulated second, µs.
    pub us_per_simulated_s: f64,
    /// Spread of the repeats: (third quartile − first quartile)/median.
    pub time_spread: f64,
}

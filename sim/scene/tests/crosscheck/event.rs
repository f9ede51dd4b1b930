//! Events reported by the solver.

use crate::double_double::Dd;
use crepitus_model::EventKind;

/// Cause of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The torque reached a limit smoothly.
    Limit,
    /// A stick was impossible at the start.
    Start,
    /// The shaft's velocity jumped.
    VelocityJump,
    /// The shaft's acceleration jumped.
    AccelerationJump,
    /// The velocities met.
    Match,
    /// A frozen slip's time was over.
    Elapsed,
}

/// One event.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    /// Kind of the event.
    pub kind: EventKind,
    /// Cause of the event.
    pub cause: Cause,
    /// Time of the event, s.
    pub time_s: Dd,
    /// The sense before: −1, 0 (stick), +1.
    pub from: i8,
    /// The sense after.
    pub to: i8,
    /// Angle of the object just after, rad.
    pub theta_rad: Dd,
    /// Velocity of the object just after, rad/s.
    pub theta_dot_rad_s: Dd,
    /// Velocity of the shaft just after, rad/s.
    pub omega_rad_s: Dd,
    /// Torque shown just before, N·m; `None` where there is no before.
    pub torque_before_nm: Option<Dd>,
    /// Torque shown just after, N·m.
    pub torque_after_nm: Dd,
    /// Half the width of the interval that certainly holds the event, s.
    pub half_width_s: f64,
    /// |T required| − Ts at a match, relative to Ts: below 0 it sticks.
    pub excess: Option<f64>,
}

/// All events up to the end.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// The events in order.
    pub events: Vec<Event>,
    /// Times when the velocities met without crossing, s: no events.
    pub touches_s: Vec<f64>,
}

/// Reason why a problem has no certain solution here.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unsolved {
    /// The first zero could not be isolated.
    #[error("the first zero at {time_s} s cannot be isolated with 31 digits")]
    Unclear {
        /// Time of the zero, s.
        time_s: f64,
    },
    /// Events pile up at one time.
    #[error("events pile up at {time_s} s")]
    PileUp {
        /// Time of the events, s.
        time_s: f64,
    },
    /// A slip begins against its own sense.
    #[error("a slip at {time_s} s begins against its own sense")]
    Inconsistent {
        /// Time of the slip, s.
        time_s: f64,
    },
    /// More steps than the limit.
    #[error("more than {steps} steps by {time_s} s")]
    TooLong {
        /// The limit.
        steps: u32,
        /// Time reached, s.
        time_s: f64,
    },
}

//! Events that a step reports.

use crate::joint::{EventKind, Phase};
use crate::real::Real;

/// One event inside a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event<F> {
    /// Kind of the event.
    pub kind: EventKind,
    /// Fraction of the step that had passed at the event, in [0, 1].
    pub fraction: F,
    /// Phase before.
    pub from: Phase,
    /// Phase after.
    pub to: Phase,
    /// Angle of the imaginary object just after, rad.
    pub theta_rad: F,
    /// Velocity of the imaginary object just after, rad/s.
    pub theta_dot_rad_s: F,
    /// Shaft velocity Ω, rad/s.
    pub omega_rad_s: F,
    /// Torque shown just before, N·m.
    pub torque_before_nm: F,
    /// Torque shown just after, N·m.
    pub torque_after_nm: F,
}

impl<F: Real> Event<F> {
    /// Returns the event in f64.
    pub fn to_f64(&self) -> Event<f64> {
        Event {
            kind: self.kind,
            fraction: self.fraction.to_f64(),
            from: self.from,
            to: self.to,
            theta_rad: self.theta_rad.to_f64(),
            theta_dot_rad_s: self.theta_dot_rad_s.to_f64(),
            omega_rad_s: self.omega_rad_s.to_f64(),
            torque_before_nm: self.torque_before_nm.to_f64(),
            torque_after_nm: self.torque_after_nm.to_f64(),
        }
    }
}

/// The most events that one step reports. A step with more stays in its current
/// phase and continues with the rest in the next step.
pub const EVENTS_PER_STEP: usize = 8;

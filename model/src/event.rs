//! What a step reports.

use crate::phase::{EventKind, Phase};

/// One event inside a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event<F> {
    /// What happened.
    pub kind: EventKind,
    /// When: the fraction of the step that had passed, in [0, 1].
    pub fraction: F,
    /// Phase before.
    pub from: Phase,
    /// Phase after.
    pub to: Phase,
    /// Angle of the imaginary object just after, rad.
    pub theta_rad: F,
    /// Velocity of the imaginary object just before, rad/s.
    pub theta_dot_before_rad_s: F,
    /// Shaft velocity Ω, rad/s.
    pub omega_rad_s: F,
    /// Torque shown just before, N·m.
    pub torque_before_nm: F,
    /// Torque shown just after, N·m.
    pub torque_after_nm: F,
}

/// The most events that one step reports. A step that would have more goes on
/// in the phase it is in and takes the rest up in the next step.
pub const EVENTS_PER_STEP: usize = 8;

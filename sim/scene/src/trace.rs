//! What a run reports while it goes: rows of the trace, and events.
//!
//! The columns of a trace are decided once, from the effects of the scene. An
//! effect that is absent has no column. A row is a slice of numbers in the
//! order of the columns; the phase column holds -1, 0 or +1.

pub use crepitus_model::EventKind;

/// One column of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// The name in the header of `trace.csv`; its unit is part of the name.
    pub name: &'static str,
    /// How its numbers are written.
    pub kind: ColumnKind,
}

/// How the numbers of a column are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// As a number that reads back to the same bits.
    Number,
    /// As `slip-`, `stick` or `slip+` for -1, 0 and +1.
    Phase,
}

/// One event of the stick-slip object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventRecord {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// What happened.
    pub kind: EventKind,
    /// Phase before the event: -1, 0 (stick) or +1.
    pub from: i8,
    /// Phase after the event.
    pub to: i8,
    /// Angle of the imaginary object, rad.
    pub theta_rad: f64,
    /// Velocity of the shaft, rad/s.
    pub omega_rad_s: f64,
    /// Torque just before, N·m.
    pub torque_before_nm: f64,
    /// Torque just after, N·m.
    pub torque_after_nm: f64,
}

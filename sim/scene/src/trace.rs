//! Output of a run: rows of the trace, and events.
//!
//! The columns of a trace are decided once, from the effects of the scene. An
//! effect that is absent has no column. A row is a slice of numbers in the
//! order of the columns; the phase column holds -1, 0 or +1.

use crepitus_model::Event;
pub use crepitus_model::EventKind;
pub use crepitus_model::render::effects::symptom::Word;

/// One column of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// The name in the header of `trace.csv`; its unit is part of the name.
    pub name: &'static str,
    /// Format of its numbers.
    pub kind: ColumnKind,
}

/// Format of the numbers of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// As a number that reads back to the same bits.
    Number,
    /// As a whole number.
    Whole,
    /// As `slip-`, `stick` or `slip+` for -1, 0 and +1.
    Phase,
}

/// One event of the stick-slip object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventRecord {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// Kind of the event.
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

/// One event of a symptom besides crepitus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymptomEvent {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// The effect's name.
    pub effect: &'static str,
    /// Kind of the event.
    pub word: Word,
    /// Angle of the joint, rad.
    pub angle_rad: f64,
    /// Velocity of the joint just after, rad/s.
    pub omega_rad_s: f64,
    /// Torque of the effect just before, N·m.
    pub torque_before_nm: f64,
    /// Torque of the effect just after, N·m.
    pub torque_after_nm: f64,
}

impl EventRecord {
    /// The record of `event` at `time_s` since the start of the run.
    pub fn new(time_s: f64, event: &Event<f64>) -> Self {
        Self {
            time_s,
            kind: event.kind,
            from: event.from.sign(),
            to: event.to.sign(),
            theta_rad: event.theta_rad,
            omega_rad_s: event.omega_rad_s,
            torque_before_nm: event.torque_before_nm,
            torque_after_nm: event.torque_after_nm,
        }
    }
}

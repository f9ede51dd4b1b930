//! Analysis of a recording, row by row: the reconstructed imaginary object,
//! its events, the motor's torque at the joint, and a summary at the end.

mod object;
mod summary;

use crate::row::Row;
use crate::sidecar::Sidecar;
use crepitus_protocol::Revision;
use crepitus_scene::trace::EventRecord;
pub use object::Object;
use object::ObjectTracker;
use summary::Tally;
pub use summary::{RecordingSummary, seconds};

/// What follows from a row and those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derived {
    /// The imaginary object.
    pub object: Object,
    /// The event within the row's tick.
    pub event: Option<EventRecord>,
    /// Torque of the motor at the joint, from its current, N·m; NaN where the
    /// current was not measured.
    pub motor_torque_nm: f64,
}

/// An analysis in progress.
#[derive(Debug)]
pub struct Analysis<'s> {
    sidecar: &'s Sidecar,
    object: ObjectTracker,
    tally: Tally,
}

impl<'s> Analysis<'s> {
    /// Begins before the first row.
    pub fn new(sidecar: &'s Sidecar) -> Self {
        Self {
            sidecar,
            object: ObjectTracker::default(),
            tally: Tally::default(),
        }
    }

    /// Takes the next row.
    pub fn row(&mut self, row: &Row) -> Derived {
        self.tally.row(row);
        let object = self.object.follow(row, self.sidecar);
        Derived {
            object,
            event: self.object.event(row, &object),
            motor_torque_nm: self.motor_torque_nm(row),
        }
    }

    fn motor_torque_nm(&self, row: &Row) -> f64 {
        let number = |name| self.sidecar.number(Revision(row.revision), name);
        let nm_per_a = number("motor.torque_constant_nm_per_a")
            .zip(number("encoder.gear_ratio"))
            .map(|(constant, gear)| constant * gear);
        row.current_a
            .zip(nm_per_a)
            .map_or(f64::NAN, |(amperes, nm_per_a)| {
                -f64::from(amperes) * nm_per_a
            })
    }

    /// The summary of all rows so far.
    pub fn finish(self) -> RecordingSummary {
        self.tally.finish(self.sidecar)
    }
}

//! Analysis of a recording, row by row: the reconstructed imaginary object,
//! its events, the motor's torque at the joint, and a summary at the end.

mod object;
mod summary;

use crepitus_protocol::Values;
use crepitus_recording::InForce;
use crepitus_recording::Recording;
use crepitus_recording::Recount;
use crepitus_recording::Row;
use crepitus_scene::trace::EventRecord;
pub use object::Object;
use object::ObjectTracker;
pub use summary::RecordingSummary;
use summary::Tally;

/// Values derived from a row and those before it.
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
pub struct Analysis<'r> {
    recording: &'r Recording,
    in_force: InForce<'r>,
    /// The parameters of the last row, if they are known.
    values: Option<Values>,
    rows: u64,
    /// Recount of the ticks alone.
    recount: Recount<'r>,
    /// Torque of the motor at the joint by its current, N·m/A; NaN if unknown.
    nm_per_a: f64,
    object: ObjectTracker,
    tally: Tally,
}

impl<'r> Analysis<'r> {
    /// Begins before the first row.
    pub fn new(recording: &'r Recording) -> Self {
        Self {
            recording,
            in_force: recording.parameters().in_force(),
            values: None,
            rows: 0,
            recount: Recount::new(recording.accounting()),
            nm_per_a: f64::NAN,
            object: ObjectTracker::default(),
            tally: Tally::default(),
        }
    }

    /// Takes the next row.
    pub fn row(&mut self, row: &Row) -> Derived {
        if self.in_force.at(self.rows) {
            self.values = self.in_force.values();
            let number = |name| self.in_force.number(name).unwrap_or(f64::NAN);
            self.nm_per_a = number("motor.torque_constant_nm_per_a") * number("encoder.gear_ratio");
            let settings = self.in_force.joint_settings();
            self.object
                .set(settings.map(|settings| settings.parameters));
        }
        self.rows += 1;
        self.recount.row(row.tick);
        self.tally.row(row);
        let object = self.object.follow(row);
        Derived {
            object,
            event: self.object.event(row, &object),
            motor_torque_nm: row
                .current_a
                .map_or(f64::NAN, |amperes| -f64::from(amperes) * self.nm_per_a),
        }
    }

    /// The parameters in force in the last row, if they are known.
    pub fn values(&self) -> Option<&Values> {
        self.values.as_ref()
    }

    /// The summary of all rows so far.
    pub fn finish(self) -> RecordingSummary {
        self.tally
            .finish(self.recording, self.recount.differences())
    }
}

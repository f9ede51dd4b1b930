//! Parts of the board that can be broken and repaired.

use super::{Board, Controller, Health, START_TICKS};
use crate::leg::CurrentPath;
use crepitus_device::drive::coil::CoilOutput;
use crepitus_device::drive::motor::Bridge;
use crepitus_protocol::management::ResetCause;

/// Faults of the board.
impl Board {
    /// Makes an enable line stuck, or repairs it.
    pub fn set_stuck(&mut self, controller: Controller, stuck: Option<bool>) {
        match controller {
            Controller::Drive => self.drive_line.stuck = stuck,
            Controller::Comms => self.comms_line.stuck = stuck,
        }
        self.switch();
    }

    /// Lets the gate of a controller pass everything, or repairs it.
    pub fn set_stuck_gate(&mut self, controller: Controller, is_stuck: bool) {
        match controller {
            Controller::Drive => self.drive_line.gate_is_stuck = is_stuck,
            Controller::Comms => self.comms_line.gate_is_stuck = is_stuck,
        }
        self.switch();
    }

    /// A controller hangs: its pins stay as they are.
    pub fn hang(&mut self, controller: Controller) {
        *self.health(controller) = Health::Hangs;
    }

    /// A controller is reset: its pins fall, and it restarts.
    pub fn reset(&mut self, controller: Controller, cause: ResetCause) {
        self.reset_for(controller, cause, START_TICKS);
    }

    /// A controller is reset, with a start-up time in ticks: its pins fall, and it restarts.
    pub fn reset_for(&mut self, controller: Controller, cause: ResetCause, ticks: u64) {
        *self.health(controller) = Health::StartsAt(self.tick + ticks, cause);
        match controller {
            Controller::Drive => {
                self.drive_line.driven = false;
                self.bridge = Bridge::Float;
                self.coil = CoilOutput::Asleep;
                self.up.sender_reset();
            }
            Controller::Comms => {
                self.comms_line.driven = false;
                self.comms_line.read = self.comms_line.is_on();
                self.down.sender_reset();
            }
        }
        self.switch();
    }

    /// Sets whether parameters can be stored.
    pub fn set_storage(&mut self, works: bool) {
        self.storage.set_works(works);
    }

    /// Sets whether the comparator behind the monitor's amplifier works.
    pub fn set_trip(&mut self, works: bool) {
        self.trips = works;
    }

    /// Pulls the break line low, or lets go of it. Without effect on a comparator that does not work.
    pub fn pull_break(&mut self, is_low: bool) {
        self.break_is_low = is_low;
    }

    /// Lets the converter of what changes slowly run, or not.
    pub fn set_slow_converter(&mut self, converts: bool) {
        self.converts_slow = converts;
    }

    /// Sets whether the converter of the coil's current works.
    pub fn set_coil_converter(&mut self, works: bool) {
        self.converts_coil = works;
    }

    /// Sets whether one of the drive's converters works.
    pub fn set_converter(&mut self, path: CurrentPath, works: bool) {
        self.converts[path as usize] = works;
    }

    /// Sets whether the drive's crystal has half as much again as it should.
    pub fn set_fast_drive(&mut self, is_fast: bool) {
        self.drive_is_fast = is_fast;
    }

    /// Sets whether the wire by which the drive reads the enable line of comms is
    /// whole.
    pub fn set_comms_line_wire(&mut self, is_whole: bool) {
        self.comms_line_reaches_drive = is_whole;
    }

    /// Sets the length of the drive's ticks that its other timer shows, µs.
    pub fn set_interval_us(&mut self, interval_us: u32) {
        self.interval_us = interval_us;
    }

    /// Sets how often the drive's model is rendered in a tick: never by a task that hangs, or a
    /// timer that has stopped; twice by one that is too fast.
    pub fn set_renderings(&mut self, in_a_tick: u32) {
        self.renderings = in_a_tick;
    }

    /// Sets the schema hash of the drive's program from its next start on.
    pub fn set_drive_schema(&mut self, schema: u64) {
        self.drive_schema = schema;
    }

    fn health(&mut self, controller: Controller) -> &mut Health {
        match controller {
            Controller::Drive => &mut self.drive_health,
            Controller::Comms => &mut self.comms_health,
        }
    }
}

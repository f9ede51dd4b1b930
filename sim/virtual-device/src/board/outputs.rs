//! Bridge and coil, as far as lines, gates and breaks let them be driven.

use super::Board;
use crate::leg::{CurrentPath, Terminals};
use crepitus_device::board::TRIP_A;
use crepitus_device::drive::coil::CoilOutput;
use crepitus_device::drive::command::Outputs;
use crepitus_device::drive::motor::Bridge;

impl Board {
    /// The break of the coil's timer, which needs no program.
    fn check_coil_driver(&mut self) {
        if self.coil == CoilOutput::Asleep {
            self.coil_tripped = false;
        } else if self.leg.coil_faults().driver_fails {
            self.coil_tripped = true;
            self.leg.set_coil(None);
        }
    }

    /// The comparator behind the monitor's amplifier, which needs no program.
    pub(super) fn check_comparator(&mut self) {
        self.check_coil_driver();
        // A line that is held low fires again, once the flag has been cleared.
        let is_held = self.trips && self.break_is_low;
        if self.bridge == Bridge::Float && !is_held {
            self.comparator_tripped = false;
        } else if is_held || self.trips && self.is_over_trip() {
            self.comparator_tripped = true;
            self.switch();
        }
    }

    fn is_over_trip(&self) -> bool {
        self.leg.current_a(CurrentPath::Monitor).abs() > f64::from(TRIP_A)
    }

    pub(super) fn execute(&mut self, outputs: Outputs) {
        self.drive_line.driven = outputs.enable;
        self.bridge = outputs.bridge;
        // Floating is immediate; a voltage loads with the next period.
        if self.bridge == Bridge::Float || !self.drive_line.passes() {
            self.leg.set_terminals(Terminals::Open);
        }
        self.coil = outputs.coil;
        if self.coil == CoilOutput::Asleep || !self.coil_is_awake() {
            self.leg.set_coil(None);
        }
    }

    /// The bridge, as far as both lines enable it.
    pub(super) fn switch(&mut self) {
        let terminals = match self.bridge {
            Bridge::Driven(volts) if self.is_driven() => Terminals::Driven(f64::from(volts)),
            _ => Terminals::Open,
        };
        self.leg.set_terminals(terminals);
        let duty = match self.coil {
            CoilOutput::Driven(duty) if self.coil_is_awake() => Some(f64::from(duty)),
            _ => None,
        };
        self.leg.set_coil(duty);
    }

    /// The gate at the driver's nSLEEP, and the break of its timer.
    fn coil_is_awake(&self) -> bool {
        self.drive_line.is_on() && self.comms_line.is_on() && !self.coil_tripped
    }
}

//! Access to the parts of the board, for tests and faults.

use super::{BoardError, CommsSide, DriveBoard};
use crate::mcu::Reset;
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_virtual_device::leg::Leg;

impl<C: CommsSide> DriveBoard<C> {
    /// Resets of the chip since the board was switched on.
    pub fn resets(&self) -> &[(Time, Reset)] {
        &self.resets
    }

    /// Mismatches between image and wiring, each with the time of its first
    /// occurrence.
    pub fn errors(&self) -> &[(Time, BoardError)] {
        &self.errors
    }

    /// The microcontroller.
    pub fn mcu(&self) -> &Stm32f405 {
        &self.mcu
    }

    /// The microcontroller, to break it.
    pub fn mcu_mut(&mut self) -> &mut Stm32f405 {
        &mut self.mcu
    }

    /// The leg.
    pub fn leg(&self) -> &Leg {
        &self.leg
    }

    /// The leg, to break its sensors and its supply.
    pub fn leg_mut(&mut self) -> &mut Leg {
        &mut self.leg
    }

    /// Comms.
    pub fn comms(&self) -> &C {
        &self.comms
    }

    /// Comms, to break it, and for what comes and goes by USB.
    pub fn comms_mut(&mut self) -> &mut C {
        &mut self.comms
    }

    /// Returns whether halves are synchronised with the bridge's timer: the image runs.
    pub fn is_synchronised(&self) -> bool {
        self.is_synchronised
    }
}

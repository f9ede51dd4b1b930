//! Access to the parts of the board, for tests and faults.

use super::{BoardError, DriveBoard};
use crate::devices::usart::Character;
use crate::mcu::Reset;
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_board::leg::Leg;
use crepitus_device::comms::Comms;

impl DriveBoard {
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
    pub fn comms(&self) -> &Comms {
        &self.comms
    }

    /// Comms, for what comes and goes by USB.
    pub fn comms_mut(&mut self) -> &mut Comms {
        &mut self.comms
    }

    /// Records the bytes of the link from now on, for [`Self::to_drive`] and
    /// [`Self::from_drive`].
    pub fn record_bytes(&mut self) {
        self.down.keeps = true;
        self.up.keeps = true;
    }

    /// Bytes to the drive, each with the end of its stop bit.
    pub fn to_drive(&self) -> &[Character] {
        &self.down.kept
    }

    /// Bytes from the drive.
    pub fn from_drive(&self) -> &[u8] {
        &self.up.kept
    }

    /// Whether halves are synchronised with the bridge's timer: the image runs.
    pub fn is_synchronised(&self) -> bool {
        self.is_synchronised
    }
}

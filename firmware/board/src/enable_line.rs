//! The enable lines: one is driven, and read back at its far end; the drive reads
//! that of comms, too.
//!
//! The resistor that pulls it down on the power board keeps it off while a
//! controller is in reset, off, or without a program.

use crepitus_device::board::pins::{comms, drive};
use stm32f4xx_hal::gpio::{Input, Output, PB0, PB1, PB10};

/// The pin of GPIOB that drives the line, on both boards.
pub(crate) const PIN: u8 = drive::LINE.pin.number;
const _: () = assert!(drive::LINE.pin.port == 'B' && comms::LINE.pin.port == 'B');
const _: () = assert!(comms::LINE.pin.number == PIN);

/// The line.
#[derive(Debug)]
pub struct EnableLine {
    drives: PB0<Output>,
    reads: PB1<Input>,
}

impl EnableLine {
    /// The line, off.
    pub fn new(drives: PB0, reads: PB1) -> Self {
        let mut drives = drives.into_push_pull_output();
        drives.set_low();
        Self {
            drives,
            reads: reads.into_pull_down_input(),
        }
    }

    /// Drives the line.
    pub fn set(&mut self, on: bool) {
        self.drives.set_state(on.into());
    }

    /// Reads the line back.
    pub fn is_on(&self) -> bool {
        self.reads.is_high()
    }
}

/// The line of the other controller, at its gate.
#[derive(Debug)]
pub struct OtherLine(PB10<Input>);

impl OtherLine {
    /// Off, where nothing drives it.
    pub fn new(reads: PB10) -> Self {
        Self(reads.into_pull_down_input())
    }

    /// Reads the line.
    pub fn is_on(&self) -> bool {
        self.0.is_high()
    }
}

//! Setup of all pins, as the registers of the ports have it.

use super::part::registers;
use crate::pins::{Mode, Pin, PinSetup, Pull};
use rsemu::core::space::{MemAttrs, MemOps};
use rsemu::dev::stm32::gpio::Gpio;
use std::sync::Arc;

/// The pins of all ports.
#[derive(Debug)]
pub(crate) struct Pins(Vec<Arc<dyn MemOps>>);

impl Pins {
    pub(crate) fn new(ports: &[Arc<Gpio>]) -> Self {
        Self(ports.iter().map(|port| registers(&**port)).collect())
    }

    fn word(&self, pin: Pin, offset: u64) -> u32 {
        let mut bytes = [0; 4];
        if let Some(port) = self.0.get(pin.port()) {
            // A debugger's read of a register that there is cannot fail.
            let _ = port.read(offset, &mut bytes, MemAttrs::DEBUG);
        }
        u32::from_le_bytes(bytes)
    }

    /// The mode of a pin.
    pub(crate) fn mode(&self, pin: Pin) -> Mode {
        let number = pin.number();
        match self.word(pin, 0x00) >> (2 * number) & 3 {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => {
                let functions = self.word(pin, 0x20 + 4 * u64::from(number / 8));
                Mode::Alternate((functions >> (4 * (number % 8)) & 15).to_le_bytes()[0])
            }
            _ => Mode::Analog,
        }
    }

    /// The setup of a pin.
    pub(crate) fn setup(&self, pin: Pin) -> PinSetup {
        let number = pin.number();
        PinSetup {
            mode: self.mode(pin),
            pull: match self.word(pin, 0x0c) >> (2 * number) & 3 {
                1 => Pull::Up,
                2 => Pull::Down,
                _ => Pull::None,
            },
            is_open_drain: self.word(pin, 0x04) >> number & 1 == 1,
        }
    }
}

//! Setup of pins: what connects a peripheral to its pin.

use crate::chip::part::registers;
use crate::mcu::Pin;
use rsemu::core::space::{MemAttrs, MemOps};
use rsemu::dev::stm32::gpio::Gpio;
use std::fmt;
use std::sync::Arc;

/// Mode of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Read by the program.
    Input,
    /// Driven by the program.
    Output,
    /// Connected to a peripheral, by the number of the alternate function.
    Alternate(u8),
    /// Connected to the converter.
    Analog,
}

/// Internal resistor of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pull {
    /// None.
    None,
    /// Resistor to the supply.
    Up,
    /// Resistor to ground.
    Down,
}

/// Setup of a pin, as the registers of its port say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PinSetup {
    /// Mode.
    pub mode: Mode,
    /// Internal resistor.
    pub pull: Pull,
    /// Driven low only.
    pub is_open_drain: bool,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input => f.write_str("input"),
            Self::Output => f.write_str("output"),
            Self::Alternate(function) => write!(f, "AF{function}"),
            Self::Analog => f.write_str("analog"),
        }
    }
}

impl fmt::Display for Pull {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "no pull",
            Self::Up => "pull-up",
            Self::Down => "pull-down",
        })
    }
}

impl fmt::Display for PinSetup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.mode, self.pull)?;
        if self.is_open_drain {
            f.write_str(", open drain")?;
        }
        Ok(())
    }
}

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

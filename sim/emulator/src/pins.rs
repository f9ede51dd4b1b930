//! Pins and their setup: what connects a peripheral to its pin.

use crepitus_device::board::{self, Connection};
use std::fmt;

/// A pin: `Pin::new('B', 12)` is PB12.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pin {
    port: u8,
    number: u8,
}

impl Pin {
    /// A pin of a port from 'A' to 'I'.
    pub const fn new(port: char, number: u8) -> Self {
        Self {
            port: (port as u8).wrapping_sub(b'A'),
            number,
        }
    }

    /// The pin of a connection of the board description.
    pub const fn of(connection: &Connection) -> Self {
        Self::new(connection.pin.port, connection.pin.number)
    }

    /// Port of the pin, counted from A.
    pub const fn port(self) -> usize {
        self.port as usize
    }

    /// Number of the pin in its port.
    pub const fn number(self) -> u32 {
        self.number as u32
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.port), self.number)
    }
}

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

impl Mode {
    /// The mode that a connection of the board description needs.
    pub const fn of(connection: &Connection) -> Self {
        match connection.mode {
            board::Mode::Input => Self::Input,
            board::Mode::Output => Self::Output,
            board::Mode::Alternate(function) => Self::Alternate(function),
            board::Mode::Analog => Self::Analog,
        }
    }
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

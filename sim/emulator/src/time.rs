//! Virtual time: exact counts of 1/336 MHz, in which a tick of every relevant
//! clock of the chip is a whole number of units.
//!
//! | clock | MHz | units a tick |
//! |---|---|---|
//! | core, AHB, timers of APB2 | 168 | 2 |
//! | APB2, timers of APB1 | 84 | 4 |
//! | PLL48 | 48 | 7 |
//! | internal oscillator, at reset | 16 | 21 |
//! | crystal | 8 | 42 |
//! | oscillator of the watchdog, nominal | 0.032 | 10,500 |

use std::ops::{Add, AddAssign, Sub};

/// Units in a second.
pub const UNITS_PER_S: u64 = 336_000_000;

/// A time or a duration. Wraps after 1,700 years.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Time(u64);

impl Time {
    /// Zero.
    pub const ZERO: Self = Self(0);

    /// Converts from units.
    pub const fn from_units(units: u64) -> Self {
        Self(units)
    }

    /// Converts from microseconds.
    pub const fn from_us(us: u64) -> Self {
        Self(us * (UNITS_PER_S / 1_000_000))
    }

    /// Units.
    pub const fn units(self) -> u64 {
        self.0
    }

    /// Whole clocks of 168 MHz.
    pub const fn cycles(self) -> u64 {
        self.0 / 2
    }

    /// Whole milliseconds.
    pub const fn milliseconds(self) -> u64 {
        self.0 / (UNITS_PER_S / 1_000)
    }

    /// Seconds, for display.
    #[expect(clippy::cast_precision_loss, reason = "for people")]
    pub fn as_s(self) -> f64 {
        self.0 as f64 / UNITS_PER_S as f64
    }
}

impl Add for Time {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl AddAssign for Time {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl Sub for Time {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

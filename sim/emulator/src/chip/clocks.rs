//! Frequencies of the chip's clocks, from its reset and clock controller.

use crate::time::UNITS_PER_S;
use rsemu::dev::stm32::rcc::{ClockOutput, Clocks};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The clock of a part of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    /// The core, its memory and the DMA.
    Core,
    /// APB1.
    Apb1,
    /// APB2.
    Apb2,
    /// Timers of APB1.
    Timers1,
    /// Timers of APB2.
    Timers2,
    /// The third output of the PLL.
    Pll48,
    /// The crystal.
    Crystal,
    /// The watchdog's own oscillator.
    Low,
    /// None: units of time.
    Time,
}

const CLOCKS: [Clock; 9] = [
    Clock::Core,
    Clock::Apb1,
    Clock::Apb2,
    Clock::Timers1,
    Clock::Timers2,
    Clock::Pll48,
    Clock::Crystal,
    Clock::Low,
    Clock::Time,
];

/// Nominal frequency of the watchdog's oscillator, Hz; 17 to 47 kHz on silicon.
pub(crate) const LOW_HZ: u64 = 32_000;

/// Units of time in a tick of each clock.
///
/// A rate that does not divide 336 MHz is rounded to whole units: the firmware
/// uses none.
#[derive(Debug)]
pub(crate) struct Rates {
    tree: Arc<Clocks>,
    generation: AtomicU64,
    units: [AtomicU64; CLOCKS.len()],
}

impl Rates {
    pub(crate) fn new(tree: Arc<Clocks>, crystal_hz: u64) -> Self {
        let rates = Self {
            tree,
            generation: AtomicU64::new(u64::MAX),
            units: [const { AtomicU64::new(1) }; CLOCKS.len()],
        };
        rates.set_units(Clock::Low, UNITS_PER_S / LOW_HZ);
        rates.set_units(Clock::Crystal, UNITS_PER_S / crystal_hz.max(1));
        rates.refresh();
        rates
    }

    /// Units of time in a tick.
    pub(crate) fn units(&self, clock: Clock) -> u64 {
        self.units[clock as usize].load(Relaxed)
    }

    pub(crate) fn set_units(&self, clock: Clock, units: u64) {
        self.units[clock as usize].store(units.max(1), Relaxed);
    }

    /// Reads the clock tree; returns whether the program has changed it.
    pub(crate) fn refresh(&self) -> bool {
        let generation = self.tree.generation();
        if self.generation.swap(generation, Relaxed) == generation {
            return false;
        }
        for (clock, output) in [
            (Clock::Core, ClockOutput::HCLK),
            (Clock::Apb1, ClockOutput::PCLK1),
            (Clock::Apb2, ClockOutput::PCLK2),
            (Clock::Timers1, ClockOutput::TIMCLK1),
            (Clock::Timers2, ClockOutput::TIMCLK2),
            (Clock::Pll48, ClockOutput::PLL48),
        ] {
            let rate = self.tree.rate(output);
            let units = (UNITS_PER_S * rate.den()).checked_div(rate.num());
            // A clock that stands has no ticks to speak of; nothing counts it.
            self.set_units(clock, units.unwrap_or(u64::from(u32::MAX)));
        }
        true
    }
}

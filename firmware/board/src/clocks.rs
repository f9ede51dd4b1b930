//! 168 MHz from the board's crystal, once that was measured.
//!
//! | clock | MHz | for |
//! |---|---|---|
//! | core, AHB | 168 | |
//! | APB2 | 84, timers 168 | TIM1, converter, USART6 |
//! | APB1 | 42, timers 84 | TIM2 to TIM5 |
//! | PLL48 | 48 | USB, random numbers |
//!
//! A crystal of another frequency than the board description's, or none, is a fault of the
//! [self-test](crepitus_device::self_test): the internal oscillator clocks everything then, within 4 %,
//! so that the fault can be reported; nothing is armed.
//!
//! Flash is read with both caches and with prefetch: without it, as the errata sheet ES0182 (ADC accuracy) asks
//! for, a tick with all symptoms would not end in time (decision 97 in docs/decisions.md).

use crate::crystal;
use crepitus_device::board::{CRYSTAL_HZ, crystal_near};
use stm32f4xx_hal::pac::{RCC, TIM11};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// APB2, Hz.
pub const APB2_HZ: u32 = 84_000_000;

/// Timers of APB2, Hz.
pub const APB2_TIMER_HZ: u32 = 168_000_000;

/// Timers of APB1, Hz.
pub const APB1_TIMER_HZ: u32 = 84_000_000;

/// Starts the clocks; returns the crystal's frequency as measured, Hz. A crystal that stops
/// later is an unhandled interrupt, so off.
pub fn start(mut rcc: RCC, meter: &TIM11) -> (Rcc, u32) {
    let crystal_hz = crystal::measure(&mut rcc, meter);
    let is_right = crystal_near(crystal_hz) == Some(CRYSTAL_HZ);
    let rcc = if is_right {
        rcc.freeze(with_core(Config::hse(CRYSTAL_HZ.Hz())))
    } else {
        rcc.freeze(with_core(Config::hsi()))
    };
    if is_right {
        rcc.cr().modify(|_, w| w.csson().set_bit());
    }
    (rcc, crystal_hz)
}

fn with_core(config: Config) -> Config {
    config.sysclk(168.MHz()).require_pll48clk()
}

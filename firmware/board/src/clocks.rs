//! 168 MHz from the crystal of 8 MHz.
//!
//! | clock | MHz | for |
//! |---|---|---|
//! | core, AHB | 168 | |
//! | APB2 | 84, timers 168 | TIM1, converter, USART6 |
//! | APB1 | 42, timers 84 | TIM2 to TIM5 |
//! | PLL48 | 48 | USB, random numbers |

use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Timers of APB2, Hz.
pub const APB2_TIMER_HZ: u32 = 168_000_000;

/// Timers of APB1, Hz.
pub const APB1_TIMER_HZ: u32 = 84_000_000;

/// Starts the clocks. Without a crystal it waits for ever, with all outputs
/// off; a crystal that stops later is an unhandled interrupt, so off, too.
pub fn start(rcc: RCC) -> Rcc {
    let config = Config::hse(8.MHz()).sysclk(168.MHz()).require_pll48clk();
    let rcc = rcc.freeze(config);
    rcc.cr().modify(|_, w| w.csson().set_bit());
    rcc
}

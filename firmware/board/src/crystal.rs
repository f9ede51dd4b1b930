//! The crystal's frequency, measured by the internal oscillator before anything is clocked by it.
//!
//! ```text
//! crystal ─> RTCPRE, / 31 ─> TI1 of TIM11, every eighth edge ─> count of the internal 16 MHz
//! ```
//!
//! RM0090 has this path for that purpose: "internal/external clock measurement using TIM11". A crystal of
//! 12 MHz for one of 8 would mean 252 MHz, and a program that hangs without a word.

use crate::raw;
use stm32f4xx_hal::pac::{RCC, TIM11};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// Internal oscillator, which clocks core and timer after a reset, Hz.
const INTERNAL_HZ: u32 = 16_000_000;

/// Divider of the crystal, and edges of the result in a capture.
const DIVIDER: u8 = 31;
const EDGES: u32 = 8;

/// Captures of a measurement: 8 MHz take 31 µs each, 496 counts.
const CAPTURES: u32 = 8;

/// Timeout of the crystal's start, in polls of some ten clocks: 20 ms. It takes 2 ms.
const START_POLLS: u32 = 32_000;

/// Timeout of a capture, in polls: of 1 MHz.
const CAPTURE_POLLS: u32 = 1_000;

/// Starts the crystal and measures its frequency, Hz; 0 without one. The core has to be clocked by the
/// internal oscillator, as after a reset.
pub(crate) fn measure(rcc: &mut RCC, timer: &TIM11) -> u32 {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if !(0..START_POLLS).any(|_| rcc.cr().read().hserdy().bit()) {
        return 0;
    }
    rcc.cfgr().modify(|_, w| w.rtcpre().set(DIVIDER));
    TIM11::enable(rcc);
    TIM11::reset(rcc);
    raw::crystal_to_timer(timer);
    timer
        .ccmr1_input()
        .write(|w| w.cc1s().ti1().ic1psc().eight_events());
    timer.ccer().write(|w| w.cc1e().set_bit());
    timer.arr().write(|w| w.arr().set(u16::MAX));
    timer.cr1().write(|w| w.cen().set_bit());
    let counts = first_to_last(timer);
    TIM11::reset(rcc);
    TIM11::disable(rcc);
    rcc.cfgr().modify(|_, w| w.rtcpre().set(0));
    let periods = CAPTURES * EDGES * u32::from(DIVIDER);
    // Below 2³²: at most 4 µs a count.
    (INTERNAL_HZ / 16 * periods)
        .checked_div(counts)
        .map_or(0, |sixteenths| sixteenths.saturating_mul(16))
}

/// Counts from one capture to the one so many later; 0 if one does not come.
fn first_to_last(timer: &TIM11) -> u32 {
    let capture = || {
        (0..CAPTURE_POLLS)
            .any(|_| timer.sr().read().cc1if().bit())
            // Reading clears the flag.
            .then(|| timer.ccr1().read().ccr().bits())
    };
    let Some(first) = capture() else { return 0 };
    let mut last = first;
    for _ in 0..CAPTURES {
        let Some(next) = capture() else { return 0 };
        last = next;
    }
    last.wrapping_sub(first).into()
}

//! How a controller starts: why, and which start this is.

use crate::kept::{Kept, Reason};
use crate::raw;
use crate::reset_cause::{Flags, reset_cause};
use crepitus_protocol::management::ResetCause;
use stm32f4xx_hal::pac::{RCC, RNG};
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// Polls of the random number generator; it takes 40 clocks of 48 MHz.
const MOST_POLLS: u32 = 10_000;

/// What is known of a start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Why.
    pub cause: ResetCause,
    /// Which one: the other controller notices a restart by it. The first
    /// after power was off is random, so two of those differ.
    pub number: u16,
    /// What the program before has left.
    pub before: Kept,
}

/// Looks at flags and words, and clears them for the next start. Once, with
/// the clocks running.
pub fn start(rcc: &mut Rcc, generator: &RNG) -> Start {
    let csr = rcc.csr().read();
    let flags = Flags {
        power_on: csr.porrstf().bit(),
        brown_out: csr.borrstf().bit(),
        watchdog: csr.wdgrstf().bit() || csr.wwdgrstf().bit(),
    };
    rcc.csr().modify(|_, w| w.rmvf().clear());
    let kept = Kept::of(raw::kept_words());
    let number = match kept {
        Some(kept) => kept.start.wrapping_add(1),
        None => random(rcc, generator),
    };
    let words = Kept {
        start: number,
        reason: Reason::None,
        detail: 0,
    }
    .words();
    raw::keep_words(words);
    Start {
        cause: reset_cause(flags, kept.as_ref()),
        number,
        before: kept.unwrap_or_default(),
    }
}

fn random(rcc: &mut RCC, generator: &RNG) -> u16 {
    RNG::enable(rcc);
    generator.cr().write(|w| w.rngen().set_bit());
    let mut number = 0;
    for _ in 0..MOST_POLLS {
        if generator.sr().read().drdy().bit() {
            // Both halves, so that a generator that is stuck matters less.
            let word = generator.dr().read().bits();
            number = (word ^ (word >> 16)) & 0xffff;
            break;
        }
    }
    generator.cr().reset();
    u16::try_from(number).unwrap_or_default()
}

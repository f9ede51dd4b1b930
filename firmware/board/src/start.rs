//! Reset cause and start counter.

use crate::crash;
use crate::raw;
use crate::reset_cause::{Flags, reset_cause};
use crate::reset_record::{Reason, ResetRecord};
use crepitus_protocol::management::ResetCause;
use stm32f4xx_hal::pac::{RCC, RNG};
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// Timeout of the random number generator, in polls; it takes 40 clocks of
/// 48 MHz.
const MOST_POLLS: u32 = 10_000;

/// A start of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Reset cause.
    pub cause: ResetCause,
    /// Start counter, by which the other controller detects a restart. Random
    /// after power was off, so that two such starts differ.
    pub number: u16,
    /// Random, and another number at each start even if the generator fails.
    pub entropy: u64,
    /// The record that the last program stored.
    pub before: ResetRecord,
}

/// Reads the reset flags and the record, and clears them for the next start.
/// Called once, with the clocks running.
pub fn start(rcc: &mut Rcc, generator: &RNG) -> Start {
    let csr = rcc.csr().read();
    let flags = Flags {
        power_on: csr.porrstf().bit(),
        brown_out: csr.borrstf().bit(),
        watchdog: csr.wdgrstf().bit() || csr.wwdgrstf().bit(),
    };
    rcc.csr().modify(|_, w| w.rmvf().clear());
    let record = ResetRecord::of(raw::record_words());
    let [high, low] = random(rcc, generator);
    let number = match record {
        Some(record) => record.start.wrapping_add(1),
        // Both halves, in case the generator has stuck bits.
        None => u16::try_from((low ^ (low >> 16)) & 0xffff).unwrap_or_default(),
    };
    let words = ResetRecord {
        start: number,
        reason: Reason::None,
        detail: 0,
    }
    .words();
    raw::store_record_words(words);
    let cause = reset_cause(flags, record.as_ref());
    crash::complete(cause, record.as_ref());
    Start {
        cause,
        number,
        entropy: (u64::from(high) << 32 | u64::from(low)) ^ u64::from(number),
        before: record.unwrap_or_default(),
    }
}

/// Two numbers of the generator; 0 where it fails.
fn random(rcc: &mut RCC, generator: &RNG) -> [u32; 2] {
    RNG::enable(rcc);
    generator.cr().write(|w| w.rngen().set_bit());
    let numbers = [(); 2].map(|()| {
        for _ in 0..MOST_POLLS {
            if generator.sr().read().drdy().bit() {
                return generator.dr().read().bits();
            }
        }
        0
    });
    generator.cr().reset();
    numbers
}

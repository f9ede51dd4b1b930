//! The CRC unit, for checksums of frames.
//!
//! The unit divides by the polynomial of our checksum, highest bit first, and begins
//! with all ones (RM0090 4.3). Ours goes lowest bit first and on from any
//! register: so bits are reversed on the way in and out, and the first word
//! carries the difference of the registers.

use crepitus_protocol::frame::{WORD, WordCrc};
use stm32f4xx_hal::pac::CRC;
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// The unit.
pub struct CrcUnit(CRC);

impl CrcUnit {
    /// Switches its clock on.
    pub fn new(unit: CRC, rcc: &mut Rcc) -> Self {
        CRC::enable(rcc);
        Self(unit)
    }
}

impl WordCrc for CrcUnit {
    fn update(&mut self, register: u32, words: &[[u8; WORD]]) -> u32 {
        let Some((first, rest)) = words.split_first() else {
            return register;
        };
        self.0.cr().write(|w| w.reset().set_bit());
        let reversed = |word: &[u8; WORD]| u32::from_le_bytes(*word).reverse_bits();
        let feed = |word| self.0.dr().write(|w| w.dr().set(word));
        feed(reversed(first) ^ !register.reverse_bits());
        rest.iter().map(reversed).for_each(|word| {
            feed(word);
        });
        self.0.dr().read().bits().reverse_bits()
    }
}

//! Checksum of frames and records: CRC-32/ISO-HDLC, that of zlib and Ethernet.

use core::fmt::{self, Debug, Formatter};
use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Bytes of the checksum.
pub const CRC_BYTES: usize = 4;

/// The checksum of both wires.
pub static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Incremental checksum: the register of the CRC, lowest bit first.
#[derive(Clone, Copy)]
pub(crate) struct Checksum(u32);

impl Checksum {
    pub(crate) fn new() -> Self {
        Self(u32::MAX)
    }

    #[inline]
    pub(crate) fn update(&mut self, bytes: &[u8]) {
        // `Crc` takes the register highest bit first, and returns it inverted.
        let mut digest = CRC.digest_with_initial(self.0.reverse_bits());
        digest.update(bytes);
        self.0 = !digest.finalize();
    }

    /// [`Self::update`] with whole words by a unit.
    #[inline]
    pub(crate) fn update_by(&mut self, unit: &mut impl WordCrc, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks();
        if !words.is_empty() {
            self.0 = unit.update(self.0, words);
        }
        if !rest.is_empty() {
            self.update(rest);
        }
    }

    pub(crate) fn value(self) -> u32 {
        !self.0
    }
}

impl Debug for Checksum {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "Checksum({:#010x})", self.value())
    }
}

/// Computes the checksum of whole words; a microcontroller has a unit for it.
pub trait WordCrc {
    /// Returns the register of the CRC, lowest bit first, after these words.
    fn update(&mut self, register: u32, words: &[[u8; WORD]]) -> u32;
}

/// Implementation in software.
#[derive(Clone, Copy, Debug, Default)]
pub struct SoftwareCrc;

impl WordCrc for SoftwareCrc {
    fn update(&mut self, register: u32, words: &[[u8; WORD]]) -> u32 {
        let mut checksum = Checksum(register);
        checksum.update(words.as_flattened());
        checksum.0
    }
}

/// Bytes of a word.
pub const WORD: usize = 4;

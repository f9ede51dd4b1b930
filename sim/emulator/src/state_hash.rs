//! A hash of a state, for comparing two runs.

/// FNV-1a, eight bytes at a time.
pub(crate) struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    pub(crate) fn value(&self) -> u64 {
        self.0
    }

    /// Takes bytes in.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let word = chunk
                .iter()
                .fold(0_u64, |all, byte| all << 8 | u64::from(*byte));
            self.0 = (self.0 ^ word).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Takes words in.
    pub(crate) fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        for word in words {
            self.bytes(&word.to_le_bytes());
        }
    }
}

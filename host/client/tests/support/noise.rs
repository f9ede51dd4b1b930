//! A wire that corrupts bytes, the same ones in each run.

/// Disturbances of bytes, each once in this many on average; 0: never.
#[derive(Clone, Debug, Default)]
pub struct Noise {
    /// Lost.
    pub lose: u64,
    /// One bit flipped.
    pub flip: u64,
    /// Twice.
    pub double: u64,
    /// Number of further bytes to lose.
    pub swallow: usize,
    state: u64,
}

impl Noise {
    /// Gives what comes of bytes.
    pub fn pass(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut out = Vec::with_capacity(bytes.len());
        for byte in bytes {
            if self.swallow > 0 {
                self.swallow -= 1;
                continue;
            }
            if self.strikes(self.lose) {
                continue;
            }
            let spoilt = if self.strikes(self.flip) {
                byte ^ 1 << (self.next() % 8)
            } else {
                *byte
            };
            out.push(spoilt);
            if self.strikes(self.double) {
                out.push(spoilt);
            }
        }
        out
    }

    fn strikes(&mut self, once_in: u64) -> bool {
        once_in != 0 && self.next().is_multiple_of(once_in)
    }

    /// SplitMix64.
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

//! A wire that corrupts bytes, the same ones in each run.

use fastrand::Rng;

/// Disturbances of bytes, each once in this many on average; 0: never.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Lost.
    pub lose: u64,
    /// One bit flipped.
    pub flip: u64,
    /// Twice.
    pub double: u64,
    /// Number of further bytes to lose.
    pub swallow: usize,
    random: Rng,
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            lose: 0,
            flip: 0,
            double: 0,
            swallow: 0,
            random: Rng::with_seed(0),
        }
    }
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
                byte ^ 1 << self.random.u8(..8)
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
        once_in != 0 && self.random.u64(..once_in) == 0
    }
}

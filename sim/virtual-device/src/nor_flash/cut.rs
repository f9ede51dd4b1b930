//! Result of an operation that was cut off.

/// Progress of an operation that was cut off, in parts of [`WHOLE`].
#[derive(Clone, Copy, Debug)]
pub struct Cut(u32);

/// Parts of an operation.
pub const WHOLE: u32 = 1024;

/// Progress from which on every bit of an erased sector reads as one, in parts of [`WHOLE`].
const READS_BLANK: u32 = 922;

/// Threshold at which a bit changes: from 0, at once, to 1,023.
fn threshold(at: usize, bit: u32) -> u32 {
    let n = (at as u64 * 8 + u64::from(bit)).wrapping_add(1);
    let n = (n ^ n >> 29).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    u32::try_from(n >> 54).unwrap_or(0)
}

/// Bits whose threshold is below `limit`.
fn easy(at: usize, limit: u32) -> u8 {
    (0..8)
        .filter(|bit| threshold(at, *bit) < limit)
        .fold(0, |bits, bit| bits | 1 << bit)
}

impl Cut {
    /// Returns the progress after `done` of `all`.
    pub fn at(done: u64, all: u64) -> Self {
        let part = u64::from(WHOLE) * done.min(all) / all.max(1);
        Self(u32::try_from(part).unwrap_or(WHOLE))
    }

    /// Some of the bits that should be cleared are.
    pub fn program(self, at: usize, old: &mut [u8], new: &[u8]) {
        for ((at, old), new) in (at..).zip(old).zip(new) {
            *old &= new | !easy(at, self.0);
        }
    }

    /// A third of the time everything is programmed to zero, then bits turn to one.
    pub fn erase(self, at: usize, bytes: &mut [u8]) {
        let third = WHOLE / 3;
        if self.0 < third {
            let done = bytes.len() * self.0 as usize / third as usize;
            bytes[..done].fill(0);
            return;
        }
        let limit = (self.0 - third) * WHOLE / (READS_BLANK - third);
        for (at, byte) in (at..).zip(bytes) {
            *byte = easy(at, limit);
        }
    }
}

/// Whether the cells of a sector are marginal: its erasure was cut off, and none
/// was completed since.
#[derive(Clone, Copy, Debug, Default)]
pub struct Marginal {
    is_marginal: bool,
    has_started: bool,
}

impl Marginal {
    /// Returns the state of a sector after an erasure, complete or cut off.
    pub fn after(cut: Option<Cut>) -> Self {
        Self {
            is_marginal: cut.is_some(),
            has_started: false,
        }
    }

    /// A start. From the second one on, one cell in some hundred that read as one
    /// reads as zero.
    pub fn start(&mut self, at: usize, bytes: &mut [u8]) {
        const WEAK: u32 = 4;
        if self.is_marginal && std::mem::replace(&mut self.has_started, true) {
            for (at, byte) in (at..).zip(bytes) {
                *byte &= !easy(at, WEAK);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_erasure_passes_through_zero_and_through_ones_that_do_not_last() {
        let content = |done| {
            let mut bytes = vec![0x5a; 4096];
            Cut::at(done, 1000).erase(0, &mut bytes);
            bytes
        };
        let ones = |bytes: &[u8]| bytes.iter().map(|byte| byte.count_ones()).sum::<u32>();
        assert!(content(0).iter().all(|byte| *byte == 0x5a));
        assert!(content(150).contains(&0x5a));
        assert!(ones(&content(334)) < 100);
        assert!((8_000..24_000).contains(&ones(&content(600))));
        let mut blank = content(950);
        let mut marginal = Marginal::after(Some(Cut::at(950, 1000)));
        marginal.start(0, &mut blank);
        assert!(blank.iter().all(|byte| *byte == 0xff));
        marginal.start(0, &mut blank);
        assert!(blank.iter().any(|byte| *byte != 0xff));
    }

    #[test]
    fn a_byte_that_was_cut_off_has_bits_of_both() {
        let content = |done| {
            let mut bytes = vec![0xff; 64];
            Cut::at(done, 16).program(0, &mut bytes, &[0x0f; 64]);
            bytes
        };
        assert_eq!(content(0), [0xff; 64]);
        assert_eq!(content(16), [0x0f; 64]);
        let half = content(8);
        assert!(half.iter().all(|byte| byte & 0x0f == 0x0f));
        assert!(half.iter().any(|byte| !matches!(byte, 0x0f | 0xff)));
    }
}

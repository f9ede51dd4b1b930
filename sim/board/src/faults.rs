//! Faults of a wire, frame by frame, reproducible by seed.

use crepitus_protocol::frame::{FRAME_BYTES, Frame};
use fastrand::Rng;

/// Faults of a wire. Shares are of frames, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Share of frames that vanish.
    pub loss: f64,
    /// Share of frames with one flipped bit somewhere, or with some.
    pub corruption: f64,
    /// Share of frames that arrive twice.
    pub duplication: f64,
    /// Share of frames whose end is missing.
    pub truncation: f64,
    /// Largest delay of a frame, ticks: each has a random one up to this, and
    /// may be overtaken.
    pub delay_ticks: u32,
    /// The wire is cut: nothing arrives.
    pub is_cut: bool,
}

/// Puts faults into a wire.
#[derive(Clone, Debug)]
pub struct FaultInjector {
    /// Current faults.
    pub faults: Faults,
    rng: Rng,
}

impl FaultInjector {
    /// A wire without faults; later ones depend on this seed.
    pub fn new(seed: u64) -> Self {
        Self {
            faults: Faults::default(),
            rng: Rng::with_seed(seed),
        }
    }

    /// Passes a frame; `arrives` gets delay, ticks, and bytes of each arrival.
    pub fn pass(&mut self, frame: &Frame, mut arrives: impl FnMut(u64, &[u8])) {
        let faults = self.faults;
        if faults.is_cut || self.happens(faults.loss) {
            return;
        }
        let copies = if self.happens(faults.duplication) {
            2
        } else {
            1
        };
        for _ in 0..copies {
            let mut bytes = [0; FRAME_BYTES];
            let mut length = frame.len().min(FRAME_BYTES);
            bytes[..length].copy_from_slice(&frame[..length]);
            if self.happens(faults.truncation) {
                length = self.rng.usize(0..length.max(1));
            }
            if self.happens(faults.corruption) && length > 0 {
                for _ in 0..self.rng.u32(1..=3) {
                    bytes[self.rng.usize(0..length)] ^= 1 << self.rng.u32(0..8);
                }
            }
            let late = match faults.delay_ticks {
                0 => 0,
                most => self.rng.u64(0..=u64::from(most)),
            };
            arrives(late, &bytes[..length]);
        }
    }

    fn happens(&mut self, share: f64) -> bool {
        share > 0.0 && self.rng.f64() < share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrivals(faults: Faults, frames: usize) -> Vec<(u64, Vec<u8>)> {
        let mut injector = FaultInjector::new(7);
        injector.faults = faults;
        let frame = Frame::from_slice(&[0x55; 100]).unwrap();
        let mut arrived = Vec::new();
        for _ in 0..frames {
            injector.pass(&frame, |late, bytes| arrived.push((late, bytes.to_vec())));
        }
        arrived
    }

    #[test]
    fn a_good_wire_changes_nothing() {
        let good = arrivals(Faults::default(), 50);
        assert_eq!(good, vec![(0, vec![0x55; 100]); 50]);
    }

    #[test]
    fn each_fault_does_what_it_says_about_as_often() {
        let half = |faults| arrivals(faults, 1000);
        let around = |n: usize, expected: usize| n.abs_diff(expected) < 100;
        let d = Faults::default();
        assert!(around(half(Faults { loss: 0.5, ..d }).len(), 500));
        assert!(around(
            half(Faults {
                duplication: 0.5,
                ..d
            })
            .len(),
            1500
        ));
        let changed = |arrived: Vec<(u64, Vec<u8>)>| {
            arrived.iter().filter(|(_, b)| *b != [0x55; 100]).count()
        };
        assert!(around(
            changed(half(Faults {
                corruption: 0.5,
                ..d
            })),
            500
        ));
        let short = half(Faults {
            truncation: 0.5,
            ..d
        });
        assert!(around(
            short.iter().filter(|(_, b)| b.len() < 100).count(),
            500
        ));
        let late = half(Faults {
            delay_ticks: 9,
            ..d
        });
        assert!((0..=9).all(|ticks| late.iter().any(|(l, _)| *l == ticks)));
        assert!(half(Faults { is_cut: true, ..d }).is_empty());
    }

    #[test]
    fn the_same_seed_gives_the_same_faults() {
        let faults = Faults {
            loss: 0.1,
            corruption: 0.2,
            duplication: 0.3,
            truncation: 0.1,
            delay_ticks: 30,
            is_cut: false,
        };
        assert_eq!(arrivals(faults, 200), arrivals(faults, 200));
    }
}

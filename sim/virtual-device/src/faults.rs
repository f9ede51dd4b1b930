//! Faults of a wire, frame by frame, reproducible by seed.

use crepitus_protocol::frame::{FRAME_BYTES, Frame};
use fastrand::Rng;
use std::collections::BTreeMap;

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

/// Fault of one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fate {
    /// The frame vanishes.
    Lost,
    /// The frame arrives, and so many ticks later again.
    Again(u64),
    /// The frame arrives so many ticks later, and may be overtaken.
    Late(u64),
}

/// Puts faults into a wire.
#[derive(Clone, Debug)]
pub struct FaultInjector {
    /// Current faults.
    pub faults: Faults,
    /// Faults of single frames, by [`Self::passed`] before them; in place of the
    /// others.
    pub fates: BTreeMap<u64, Fate>,
    passed: u64,
    rng: Rng,
}

impl FaultInjector {
    /// A wire without faults; later ones depend on this seed.
    pub fn new(seed: u64) -> Self {
        Self {
            faults: Faults::default(),
            fates: BTreeMap::new(),
            passed: 0,
            rng: Rng::with_seed(seed),
        }
    }

    /// Frames so far.
    pub fn passed(&self) -> u64 {
        self.passed
    }

    /// Passes a frame; `arrives` gets delay, ticks, and bytes of each arrival.
    pub fn pass(&mut self, frame: &Frame, mut arrives: impl FnMut(u64, &[u8])) {
        let fate = self.fates.get(&self.passed).copied();
        self.passed += 1;
        match fate {
            None => {}
            Some(Fate::Lost) => return,
            Some(Fate::Late(ticks)) => return arrives(ticks, frame),
            Some(Fate::Again(ticks)) => {
                arrives(0, frame);
                return arrives(ticks, frame);
            }
        }
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
    fn a_frame_has_its_fate_and_the_next_one_has_not() {
        let mut injector = FaultInjector::new(7);
        injector.fates = [(1, Fate::Lost), (2, Fate::Again(5)), (4, Fate::Late(9))].into();
        let arrived: Vec<_> = (0..6)
            .map(|n| {
                let frame = Frame::from_slice(&[n; 3]).unwrap();
                let mut arrived = Vec::new();
                injector.pass(&frame, |late, bytes| arrived.push((late, bytes.to_vec())));
                arrived
            })
            .collect();
        let at = |late, n| (late, vec![n; 3]);
        let expected = [
            vec![at(0, 0)],
            vec![],
            vec![at(0, 2), at(5, 2)],
            vec![at(0, 3)],
            vec![at(9, 4)],
            vec![at(0, 5)],
        ];
        assert_eq!(arrived, expected);
        assert_eq!(injector.passed(), 6);
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

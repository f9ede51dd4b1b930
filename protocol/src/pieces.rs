//! Fragmentation of a commit for the link to the drive.
//!
//! A long frame would delay heartbeats, and the number of parameters grows. So
//! a frame on the link carries at most [`PIECE_VALUES`] values, the revision,
//! and a checksum over all values. The receiver applies a commit only when all
//! pieces are there and the checksum is valid.

use crate::frame::CRC;
use crate::parameters::PARAMETER_COUNT;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Values in a piece: the fewer, the less a piece takes of the drive's tick.
pub const PIECE_VALUES: usize = 4;

/// Some of the values of a commit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Piece {
    /// Index of this piece; its first value has 4 times this index.
    pub index: u8,
    /// The values; 0 beyond the last.
    pub values: [f64; PIECE_VALUES],
}

impl Piece {
    /// The piece with this index, if there is one.
    pub fn of(values: &[f64], index: u8) -> Option<Self> {
        let some = values.chunks(PIECE_VALUES).nth(index.into())?;
        let mut piece = Self {
            index,
            values: [0.0; PIECE_VALUES],
        };
        for (value, given) in piece.values.iter_mut().zip(some) {
            *value = *given;
        }
        Some(piece)
    }
}

/// Checksum over all values of a commit: CRC-32 of their bytes, little endian.
pub fn checksum(values: &[f64]) -> u32 {
    let mut digest = CRC.digest();
    for value in values {
        digest.update(&value.to_le_bytes());
    }
    digest.finalize()
}

/// Reassembly of a commit from pieces in any order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reassembly<const N: usize = PARAMETER_COUNT> {
    checksum: u32,
    values: [f64; N],
    /// One bit for each missing piece.
    missing: u32,
}

impl<const N: usize> Default for Reassembly<N> {
    fn default() -> Self {
        Self::new(0)
    }
}

impl<const N: usize> Reassembly<N> {
    const ALL: u32 = {
        let pieces = N.div_ceil(PIECE_VALUES);
        assert!(pieces < 32, "more pieces than bits");
        (1 << pieces) - 1
    };

    /// Starts without pieces, for values with this checksum.
    pub fn new(checksum: u32) -> Self {
        Self {
            checksum,
            values: [0.0; N],
            missing: Self::ALL,
        }
    }

    /// Starts again without pieces, for values with this checksum. Quick: a value
    /// of before stays where it is until its piece arrives.
    pub fn restart(&mut self, checksum: u32) {
        (self.checksum, self.missing) = (checksum, Self::ALL);
    }

    /// The expected checksum of all values.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// Adds a piece; ignores an invalid index.
    pub fn add(&mut self, piece: &Piece) {
        let place = self.values.chunks_mut(PIECE_VALUES).nth(piece.index.into());
        let Some(place) = place else {
            return;
        };
        for (value, given) in place.iter_mut().zip(piece.values) {
            *value = given;
        }
        self.missing &= !(1 << piece.index);
    }

    /// Whether every piece has arrived.
    pub fn is_complete(&self) -> bool {
        self.missing == 0
    }

    /// The values, if complete and with a valid checksum.
    pub fn values(&self) -> Option<&[f64; N]> {
        (self.is_complete() && checksum(&self.values) == self.checksum).then_some(&self.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const MANY: usize = 100;

    fn pieces(values: &[f64]) -> Vec<Piece> {
        (0..).map_while(|index| Piece::of(values, index)).collect()
    }

    #[test]
    fn a_hundred_values_are_twenty_five_pieces() {
        let values: [f64; MANY] = {
            let mut next = 0.0;
            core::array::from_fn(|_| {
                next += 1.0 / 3.0;
                next
            })
        };
        let pieces = pieces(&values);
        assert_eq!(pieces.len(), 25);
        let mut reassembly = Reassembly::<MANY>::new(checksum(&values));
        for piece in &pieces {
            assert_eq!(reassembly.values(), None);
            reassembly.add(piece);
        }
        assert_eq!(reassembly.values(), Some(&values));
    }

    #[test]
    fn a_heartbeat_waits_behind_less_than_60_bytes() {
        let body = 2 + crate::link::ToDrive::POSTCARD_MAX_SIZE;
        assert!(body + crate::frame::CRC_BYTES + 2 < 60, "{body}");
    }

    #[test]
    fn a_piece_with_an_invalid_index_is_ignored() {
        let mut reassembly = Reassembly::<MANY>::new(0);
        for index in [25, 31, 32, 255] {
            let before = reassembly;
            reassembly.add(&Piece {
                index,
                values: [1.0; PIECE_VALUES],
            });
            assert_eq!(reassembly, before, "{index}");
        }
    }

    proptest! {
        /// Pieces in any order, with repeats, give the exact values; a piece of
        /// another commit among them gives none.
        #[test]
        fn reassembly_is_complete_or_fails(
            bits in prop::array::uniform32(any::<u64>()),
            order in Just((0..8_u8).cycle().take(20).collect::<Vec<_>>()).prop_shuffle(),
            (wrong, flip) in (0..32_usize, 0..64_u32),
        ) {
            let values = bits.map(f64::from_bits);
            let mut reassembly = Reassembly::<32>::new(checksum(&values));
            for index in order {
                reassembly.add(&Piece::of(&values, index).unwrap());
            }
            let whole = reassembly.values().map(|values| values.map(f64::to_bits));
            prop_assert_eq!(whole, Some(bits));

            // The next commit takes nothing of this one.
            reassembly.restart(checksum(&values));
            for index in 0..7 {
                reassembly.add(&Piece::of(&values, index).unwrap());
                prop_assert_eq!(reassembly.values(), None);
            }
            reassembly.add(&Piece::of(&values, 7).unwrap());
            prop_assert!(reassembly.values().is_some());

            let mut other = values;
            other[wrong] = f64::from_bits(bits[wrong] ^ 1 << flip);
            let index = u8::try_from(wrong / PIECE_VALUES).unwrap();
            reassembly.add(&Piece::of(&other, index).unwrap());
            prop_assert!(reassembly.is_complete() && reassembly.values().is_none());
        }
    }
}

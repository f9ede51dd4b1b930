//! Fragmentation of a commit for the link to the drive.
//!
//! A long frame would delay heartbeats, and there are many parameters, most of
//! which are at their defaults. So a frame on the link carries at most
//! [`PIECE_VALUES`] values, the revision, and a seal over all values; and only
//! the pieces that have values of their own are sent. Both sides know the defaults:
//! they are part of the schema. The receiver applies a commit only when as many
//! pieces are there as were announced and the seal is valid.
//!
//! After a restart comms counts revisions from the saved one again, so two commits may have one
//! number. The seal depends on the boot counter of comms: no piece of before a restart is taken for
//! one of after it.

use crate::checksum::CRC;
use crate::parameters::{DEFAULTS, PARAMETER_COUNT};
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

/// Pieces of all values.
const PIECES: usize = PARAMETER_COUNT.div_ceil(PIECE_VALUES);

const _: () = assert!(PIECES <= 32, "more pieces than bits");

/// The pieces of a commit that are sent, one bit each: those with a value that is
/// not at its default, and the first.
pub fn to_send(values: &[f64; PARAMETER_COUNT]) -> u32 {
    let chunks = values
        .chunks(PIECE_VALUES)
        .zip(DEFAULTS.0.chunks(PIECE_VALUES));
    let mut pieces = 1;
    for (index, (chunk, defaults)) in (0..u32::BITS).zip(chunks) {
        let same = chunk
            .iter()
            .zip(defaults)
            .all(|(value, default)| value.to_bits() == default.to_bits());
        if !same {
            pieces |= 1 << index;
        }
    }
    pieces
}

/// Seal over all values of a commit, of this start of comms: CRC-32 of their bytes, little
/// endian, XOR the start times 0x9e3779b1.
pub fn seal(values: &[f64], comms_start: u16) -> u32 {
    // Odd: each start has its own.
    checksum(values) ^ u32::from(comms_start).wrapping_mul(0x9e37_79b1)
}

fn checksum(values: &[f64]) -> u32 {
    let mut digest = CRC.digest();
    for value in values {
        digest.update(&value.to_le_bytes());
    }
    digest.finalize()
}

/// Reassembly of a commit from pieces in any order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reassembly {
    seal: u32,
    /// The start of comms that the seal has to be of.
    comms_start: u16,
    /// Values of the pieces that have arrived; the others are at their defaults.
    values: [f64; PARAMETER_COUNT],
    /// Number of pieces.
    count: u8,
    /// One bit for each that has arrived.
    arrived: u32,
}

impl Default for Reassembly {
    fn default() -> Self {
        Self::new(0, 0, 0)
    }
}

impl Reassembly {
    /// Starts without pieces, for so many of them, and values with this seal of this start of
    /// comms.
    pub fn new(seal: u32, comms_start: u16, count: u8) -> Self {
        Self {
            seal,
            comms_start,
            values: [0.0; PARAMETER_COUNT],
            count,
            arrived: 0,
        }
    }

    /// Starts again. What was there stays until its piece arrives, and counts for nothing:
    /// to clear it would take as long as a quarter of the drive's tick.
    pub fn restart(&mut self, seal: u32, comms_start: u16, count: u8) {
        (self.seal, self.comms_start) = (seal, comms_start);
        (self.count, self.arrived) = (count, 0);
    }

    /// The expected seal of all values.
    pub fn seal(&self) -> u32 {
        self.seal
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
        self.arrived |= 1_u32.unbounded_shl(piece.index.into());
    }

    /// Returns whether every piece has arrived.
    pub fn is_complete(&self) -> bool {
        self.arrived.count_ones() == u32::from(self.count)
    }

    /// The values, if complete and with a valid seal. This takes long.
    pub fn values(&self) -> Option<[f64; PARAMETER_COUNT]> {
        if !self.is_complete() {
            return None;
        }
        let mut values = DEFAULTS.0;
        let arrived = values
            .chunks_mut(PIECE_VALUES)
            .zip(self.values.chunks(PIECE_VALUES))
            .zip(0..u32::BITS)
            .filter(|(_, index)| self.arrived >> index & 1 == 1);
        for ((place, given), _) in arrived {
            for (value, given) in place.iter_mut().zip(given) {
                *value = *given;
            }
        }
        (seal(&values, self.comms_start) == self.seal).then_some(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Values;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn pieces(values: &[f64; PARAMETER_COUNT]) -> Vec<Piece> {
        let send = to_send(values);
        let sent = (0..).map_while(|index| Piece::of(values, index));
        sent.filter(|piece| send >> piece.index & 1 == 1).collect()
    }

    fn count(values: &[f64; PARAMETER_COUNT]) -> u8 {
        u8::try_from(to_send(values).count_ones()).unwrap()
    }

    #[test]
    fn defaults_are_one_piece_and_what_differs_is_sent() {
        let mut values = Values::default().0;
        assert_eq!(to_send(&values), 1);
        values[PARAMETER_COUNT - 1] = -1.0;
        values[9] = 0.7;
        assert_eq!(to_send(&values), 1 | 1 << 2 | 1 << (PIECES - 1));
        let all = [0.125; PARAMETER_COUNT];
        assert_eq!(count(&all), 32);
    }

    /// It equals the default, but the seal is over its bytes.
    #[test]
    fn a_negative_zero_for_a_default_of_zero_comes_back() {
        let negative = |value: f64| if value == 0.0 { -0.0 } else { value };
        let values = Values::default().0.map(negative);
        let mut reassembly = Reassembly::new(seal(&values, 7), 7, count(&values));
        for piece in pieces(&values) {
            reassembly.add(&piece);
        }
        let whole = reassembly.values().map(|values| values.map(f64::to_bits));
        assert_eq!(whole, Some(values.map(f64::to_bits)));
    }

    #[test]
    fn a_heartbeat_waits_behind_less_than_60_bytes() {
        let body = 2 + crate::link::ToDrive::POSTCARD_MAX_SIZE;
        assert!(body + crate::frame::CRC_BYTES + 2 < 60, "{body}");
    }

    #[test]
    fn a_piece_with_an_invalid_index_is_ignored() {
        let mut reassembly = Reassembly::new(0, 0, 1);
        for index in [32, 33, 255] {
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
            changes in prop::collection::vec((0..PARAMETER_COUNT, any::<u64>()), 1..40),
            order in any::<prop::sample::Index>(),
            (wrong, flip) in (any::<prop::sample::Index>(), 0..64_u32),
        ) {
            let mut values = Values::default().0;
            for (place, bits) in &changes {
                values[*place] = f64::from_bits(*bits);
            }
            let mut sent = pieces(&values);
            let turn = order.index(sent.len());
            sent.rotate_left(turn);
            let bits = values.map(f64::to_bits);
            let mut reassembly = Reassembly::new(seal(&values, 7), 7, count(&values));
            for piece in &sent {
                prop_assert_eq!(reassembly.values(), None);
                reassembly.add(piece);
                reassembly.add(piece);
            }
            let whole = reassembly.values().map(|values| values.map(f64::to_bits));
            prop_assert_eq!(whole, Some(bits));

            // The next commit takes nothing of this one.
            let next = Values::default().0;
            reassembly.restart(seal(&next, 7), 7, 1);
            prop_assert_eq!(reassembly.values(), None);
            reassembly.add(&Piece::of(&next, 0).unwrap());
            prop_assert_eq!(reassembly.values(), Some(next));

            reassembly.restart(seal(&values, 7), 7, count(&values));
            let wrong = wrong.index(sent.len());
            for (n, piece) in sent.iter().enumerate() {
                let mut piece = *piece;
                if n == wrong {
                    piece.values[0] = f64::from_bits(piece.values[0].to_bits() ^ 1 << flip);
                }
                reassembly.add(&piece);
            }
            prop_assert!(reassembly.is_complete() && reassembly.values().is_none());
        }
    }
}

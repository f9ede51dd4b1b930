//! A set of parameters as bytes of flash.
//!
//! ```text
//! "CRP2" ‖ sequence u32 ‖ revision u32 ‖ count u32 ‖ count × (id u8 ‖ value f64) ‖ CRC-32      little endian
//! ```
//!
//! Ids never change their meaning, so a record of another version is readable:
//! missing parameters get their default, unknown ones are skipped.

use crepitus_protocol::frame::CRC;
use crepitus_protocol::parameters::PARAMETER_COUNT;
use crepitus_protocol::{Revision, Values};

/// Bytes between the beginnings of two records: room for 225 parameters.
pub const SLOT_BYTES: usize = 2048;

const MAGIC: [u8; 4] = *b"CRP2";
const HEAD_BYTES: usize = 16;
const SUM_BYTES: usize = 4;
const VALUE_BYTES: usize = 9;

/// Bytes of a record of this version.
pub const RECORD_BYTES: usize = HEAD_BYTES + VALUE_BYTES * PARAMETER_COUNT + SUM_BYTES;

const _: () = assert!(RECORD_BYTES <= SLOT_BYTES);

/// A record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Counts records; the newest has the highest, modulo 2³².
    pub sequence: u32,
    /// Revision of the values.
    pub revision: Revision,
    /// The parameters.
    pub values: Values,
}

impl Record {
    /// Encodes the record.
    pub fn bytes(&self) -> [u8; RECORD_BYTES] {
        let mut bytes = [0; RECORD_BYTES];
        let count = u32::try_from(PARAMETER_COUNT).unwrap_or_default();
        let head = [self.sequence, self.revision.0, count];
        let body = MAGIC
            .into_iter()
            .chain(head.into_iter().flat_map(u32::to_le_bytes))
            .chain(self.values.iter().flat_map(|(parameter, value)| {
                core::iter::once(parameter.id).chain(value.to_le_bytes())
            }));
        for (place, byte) in bytes.iter_mut().zip(body) {
            *place = byte;
        }
        if let Some((body, sum)) = bytes.split_last_chunk_mut::<SUM_BYTES>() {
            *sum = CRC.checksum(body).to_le_bytes();
        }
        bytes
    }

    /// Decodes the record at the beginning of a slot, if it is valid.
    pub fn of(slot: &[u8]) -> Option<Self> {
        let (magic, rest) = slot.split_first_chunk::<4>()?;
        let (sequence, rest) = rest.split_first_chunk::<4>()?;
        let (revision, rest) = rest.split_first_chunk::<4>()?;
        let (count, rest) = rest.split_first_chunk::<4>()?;
        let count = usize::try_from(u32::from_le_bytes(*count)).ok()?;
        let value_bytes = count.checked_mul(VALUE_BYTES)?;
        let sum = rest.get(value_bytes..)?.first_chunk::<SUM_BYTES>()?;
        let body = slot.get(..HEAD_BYTES.checked_add(value_bytes)?)?;
        if *magic != MAGIC || CRC.checksum(body) != u32::from_le_bytes(*sum) {
            return None;
        }
        let mut values = Values::default();
        for stored in rest.get(..value_bytes)?.chunks_exact(VALUE_BYTES) {
            let (id, value) = stored.split_first()?;
            values.set(*id, f64::from_le_bytes(*value.first_chunk()?));
        }
        Some(Self {
            sequence: u32::from_le_bytes(*sequence),
            revision: Revision(u32::from_le_bytes(*revision)),
            values,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Record {
        let mut values = Values::default();
        values.set(crepitus_protocol::parameters::id::STATIC_TORQUE, 0.7);
        Record {
            sequence: u32::MAX,
            revision: Revision(17),
            values,
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let mut slot = [0xff; SLOT_BYTES];
        slot[..RECORD_BYTES].copy_from_slice(&record().bytes());
        assert_eq!(Record::of(&slot), Some(record()));
        for place in 0..RECORD_BYTES {
            let mut torn = slot;
            torn[place] ^= 0x10;
            assert_eq!(Record::of(&torn), None, "{place}");
            let mut torn = slot;
            torn[place..].fill(0xff);
            // A checksum may end as erased flash does.
            assert!(torn == slot || Record::of(&torn).is_none(), "{place}");
        }
        assert_eq!(Record::of(&[0xff; SLOT_BYTES]), None);
        assert_eq!(Record::of(&[]), None);
    }

    #[test]
    fn a_record_of_another_program_gives_what_there_still_is() {
        let whole = record().bytes();
        // The first five, of which the fourth is one that has gone.
        let end = HEAD_BYTES + VALUE_BYTES * 5;
        let mut slot = [0xff; SLOT_BYTES];
        slot[..end].copy_from_slice(&whole[..end]);
        slot[12..16].copy_from_slice(&5_u32.to_le_bytes());
        let gone = HEAD_BYTES + VALUE_BYTES * 3;
        slot[gone] = u8::MAX;
        let sum = CRC.checksum(&slot[..end]).to_le_bytes();
        slot[end..end + 4].copy_from_slice(&sum);
        assert_eq!(Record::of(&slot).unwrap().values, record().values);
    }
}

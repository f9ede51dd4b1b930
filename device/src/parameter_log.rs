//! Parameters in two sectors of flash, as an append-only log.
//!
//! ```text
//! sector 0  | seal | record 1 | record 2 | ... | record 7 |       16 KB each, 2 KB a slot
//! sector 1  | seal | record 8 | free | free | ...
//! ```
//!
//! Writing takes a few milliseconds; erasing a sector stops the core for
//! almost a second. So a new record goes to the next free slot, and the sector
//! without the newest one is erased at the next start, before the watchdog
//! runs. A record cut off by a power failure is invalid; the one before it
//! then is the newest.
//!
//! An erasure that was cut off may read as blank and yet lose what is written
//! there. So a sector is sealed once its erasure is complete, and only a sealed
//! one is written to. Records are read wherever they are valid.

mod record;

use core::ops::Range;
use crepitus_protocol::{Revision, Values};
pub use record::{RECORD_BYTES, Record, SLOT_BYTES};

/// Bytes of a sector.
pub const SECTOR_BYTES: usize = 16 * 1024;

/// Bytes of the log.
pub const LOG_BYTES: usize = 2 * SECTOR_BYTES;

/// Records that a sector has room for.
pub const RECORDS_PER_SECTOR: usize = SLOTS_PER_SECTOR - 1;

const SLOTS_PER_SECTOR: usize = SECTOR_BYTES / SLOT_BYTES;
const SLOTS: usize = 2 * SLOTS_PER_SECTOR;

/// Seal in the first slot of a sector whose erasure was completed.
const SEAL: [u8; 8] = *b"CRPerase";

/// The two sectors.
pub trait Sectors {
    /// The content of both, [`LOG_BYTES`].
    fn bytes(&self) -> &[u8];

    /// Writes erased bytes, or clears bits; returns whether it succeeded.
    fn write(&mut self, offset: usize, bytes: &[u8]) -> bool;

    /// Erases the first (0) or the second (1); returns whether it succeeded.
    fn erase(&mut self, sector: usize) -> bool;
}

/// The log.
#[derive(Debug)]
pub struct ParameterLog<S> {
    sectors: S,
    newest: Option<Record>,
    /// The slot for the next record, unless the log is full.
    free: Option<usize>,
}

impl<S: Sectors> ParameterLog<S> {
    /// Reads the log and erases the sector not in use, unless it is ready. That
    /// takes long: call it before the watchdog runs.
    pub fn open(mut sectors: S) -> Self {
        let (place, newest) = newest(sectors.bytes());
        let in_use = place.map(|slot| slot / SLOTS_PER_SECTOR);
        for sector in 0..2 {
            if in_use != Some(sector) && !is_ready(sectors.bytes(), sector) {
                erase(&mut sectors, sector);
            }
        }
        let free = next_free(sectors.bytes(), in_use);
        Self {
            sectors,
            newest,
            free,
        }
    }

    /// The parameters stored last.
    pub fn newest(&self) -> Option<(Revision, Values)> {
        self.newest
            .as_ref()
            .map(|record| (record.revision, record.values))
    }

    /// Stores parameters; returns whether it succeeded. Takes some
    /// milliseconds, in which the core stalls but for moments between bytes.
    pub fn store(&mut self, revision: Revision, values: &Values) -> bool {
        let Some(slot) = self.free else {
            return false;
        };
        let record = Record {
            sequence: self.newest.map_or(0, |last| last.sequence.wrapping_add(1)),
            revision,
            values: *values,
        };
        let begin = slot_begin(slot);
        let is_good = self.sectors.write(begin, &record.bytes());
        let written = slot_bytes(self.sectors.bytes(), slot);
        let is_stored = is_good && written.and_then(Record::of) == Some(record);
        if is_stored {
            self.newest = Some(record);
        }
        self.free = next_free(self.sectors.bytes(), Some(slot / SLOTS_PER_SECTOR));
        is_stored
    }

    /// The sectors.
    pub fn sectors(&self) -> &S {
        &self.sectors
    }
}

/// Erases a sector and seals it. Without success it stays unsealed.
fn erase(sectors: &mut impl Sectors, sector: usize) {
    let _ = sectors.erase(sector) && sectors.write(slot_begin(first_slot(sector)), &SEAL);
}

#[expect(clippy::arithmetic_side_effects, reason = "a slot of the log")]
const fn slot_begin(slot: usize) -> usize {
    slot * SLOT_BYTES
}

/// The slot of a sector's seal.
#[expect(clippy::arithmetic_side_effects, reason = "one of two sectors")]
const fn first_slot(sector: usize) -> usize {
    sector * SLOTS_PER_SECTOR
}

/// The slots of a sector for records.
fn records_of(sector: usize) -> Range<usize> {
    let first = first_slot(sector);
    first.saturating_add(1)..first.saturating_add(SLOTS_PER_SECTOR)
}

// Not inlined: the compiler would do so for each slot, in 20 KB.
#[inline(never)]
fn slot_bytes(bytes: &[u8], slot: usize) -> Option<&[u8]> {
    bytes.get(slot_begin(slot)..)?.get(..SLOT_BYTES)
}

#[inline(never)]
fn is_blank(bytes: &[u8], slot: usize) -> bool {
    slot_bytes(bytes, slot).is_some_and(|slot| slot.iter().all(|byte| *byte == 0xff))
}

fn is_sealed(bytes: &[u8], sector: usize) -> bool {
    slot_bytes(bytes, first_slot(sector)).is_some_and(|slot| slot.starts_with(&SEAL))
}

/// Erased, sealed, and without records.
fn is_ready(bytes: &[u8], sector: usize) -> bool {
    is_sealed(bytes, sector) && records_of(sector).all(|slot| is_blank(bytes, slot))
}

/// The newest record and its slot.
fn newest(bytes: &[u8]) -> (Option<usize>, Option<Record>) {
    let records = (0..SLOTS).filter_map(|slot| {
        let record = Record::of(slot_bytes(bytes, slot)?)?;
        Some((slot, record))
    });
    let is_later = |a: &Record, b: &Record| a.sequence.wrapping_sub(b.sequence).cast_signed() > 0;
    records
        .reduce(|best, next| {
            if is_later(&next.1, &best.1) {
                next
            } else {
                best
            }
        })
        .unzip()
}

/// The slot after the last written one of the sector in use; if that is full,
/// or not sealed, the first one of the other sector, if that is ready.
fn next_free(bytes: &[u8], in_use: Option<usize>) -> Option<usize> {
    let sector = in_use.unwrap_or(0);
    let slots = records_of(sector);
    let used = slots.clone().rfind(|slot| !is_blank(bytes, *slot));
    let next = used.map_or(slots.start, |slot| slot.saturating_add(1));
    if is_sealed(bytes, sector) && next < slots.end {
        return Some(next);
    }
    let other = 1_usize.saturating_sub(sector);
    is_ready(bytes, other).then_some(records_of(other).start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Flash in which writing only clears bits. `sim/virtual-device` has one whose power fails.
    #[derive(Debug)]
    struct Ram<'a> {
        bytes: &'a mut Vec<u8>,
        erased: usize,
    }

    impl Sectors for Ram<'_> {
        fn bytes(&self) -> &[u8] {
            self.bytes
        }

        fn write(&mut self, offset: usize, bytes: &[u8]) -> bool {
            for (place, byte) in self.bytes[offset..].iter_mut().zip(bytes) {
                assert_eq!(*place & byte, *byte, "a bit is set by writing");
                *place &= byte;
            }
            true
        }

        fn erase(&mut self, sector: usize) -> bool {
            self.erased += 1;
            self.bytes[sector * SECTOR_BYTES..][..SECTOR_BYTES].fill(0xff);
            true
        }
    }

    fn open(bytes: &mut Vec<u8>) -> ParameterLog<Ram<'_>> {
        ParameterLog::open(Ram { bytes, erased: 0 })
    }

    fn values(n: u32) -> Values {
        let mut values = Values::default();
        values.set(4, f64::from(n));
        values
    }

    #[test]
    fn every_save_is_there_at_the_next_start_for_ever() {
        let mut bytes = vec![0xff; LOG_BYTES];
        for n in 1..400 {
            let mut log = open(&mut bytes);
            assert!(log.store(Revision(n), &values(n)), "{n}");
            assert_eq!(open(&mut bytes).newest(), Some((Revision(n), values(n))));
        }
    }

    #[test]
    fn without_a_start_in_between_there_is_room_for_14_and_then_it_says_so() {
        let mut bytes = vec![0xff; LOG_BYTES];
        let mut log = open(&mut bytes);
        assert_eq!(log.sectors.erased, 2, "neither is sealed");
        let kept = (1..=100).take_while(|n| log.store(Revision(*n), &values(*n)));
        assert_eq!(kept.count(), 2 * RECORDS_PER_SECTOR);
        let mut log = open(&mut bytes);
        assert_eq!(log.newest(), Some((Revision(14), values(14))));
        assert_eq!(log.sectors.erased, 1);
        assert!(log.store(Revision(15), &values(15)));
        // The other one is full, and no longer in use.
        assert_eq!(open(&mut bytes).sectors.erased, 1);
        assert_eq!(open(&mut bytes).sectors.erased, 0);
    }

    #[test]
    fn a_sector_without_a_seal_is_read_and_not_written_to() {
        let mut bytes = vec![0xff; LOG_BYTES];
        assert!(open(&mut bytes).store(Revision(1), &values(1)));
        bytes[..SEAL.len()].fill(0xff);
        let mut log = open(&mut bytes);
        assert_eq!(log.newest(), Some((Revision(1), values(1))));
        assert!(log.store(Revision(2), &values(2)));
        assert_eq!(log.free, Some(first_slot(1) + 2));
        // The first one is erased, and sealed again.
        let mut log = open(&mut bytes);
        assert_eq!(log.sectors.erased, 1);
        assert!(log.store(Revision(3), &values(3)));
        assert_eq!(open(&mut bytes).newest(), Some((Revision(3), values(3))));
    }

    #[test]
    fn invalid_content_is_erased_and_sequences_may_wrap() {
        let mut bytes = vec![0x5a; LOG_BYTES];
        let mut log = open(&mut bytes);
        assert_eq!((log.newest(), log.sectors.erased), (None, 2));
        log.newest = Some(Record {
            sequence: u32::MAX - 1,
            revision: Revision(1),
            values: values(1),
        });
        for n in 2..6 {
            assert!(log.store(Revision(n), &values(n)));
        }
        assert_eq!(open(&mut bytes).newest(), Some((Revision(5), values(5))));
    }
}

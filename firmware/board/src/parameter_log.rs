//! Parameters in two sectors of flash, as an append-only log.
//!
//! ```text
//! sector 2  | record 1 | record 2 | ... | record 16 |       16 KB each, 1 KB a slot
//! sector 3  | record 17 | free | free | ...
//! ```
//!
//! Writing takes a few milliseconds; erasing a sector stops the core for
//! almost a second. So a new record goes to the next free slot, and the sector
//! without the newest one is erased at the next start, before the watchdog
//! runs. A record cut off by a power failure is invalid; the one before it
//! then is the newest.

use crate::parameter_record::{Record, SLOT_BYTES};
use crepitus_protocol::{Revision, Values};

/// Bytes of a sector.
pub const SECTOR_BYTES: usize = 16 * 1024;

/// Bytes of the log.
pub const LOG_BYTES: usize = 2 * SECTOR_BYTES;

const SLOTS_PER_SECTOR: usize = SECTOR_BYTES / SLOT_BYTES;
const SLOTS: usize = 2 * SLOTS_PER_SECTOR;

/// The two sectors.
pub trait Sectors {
    /// The content of both, [`LOG_BYTES`].
    fn bytes(&self) -> &[u8];

    /// Writes erased bytes; returns whether it succeeded.
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
    /// Reads the log and erases the sector not in use, which takes long: call
    /// it before the watchdog runs.
    pub fn open(mut sectors: S) -> Self {
        let (place, newest) = newest(sectors.bytes());
        let in_use = place.map(|slot| slot / SLOTS_PER_SECTOR);
        for sector in 0..2 {
            if in_use != Some(sector) && !is_blank(sectors.bytes(), sector_range(sector)) {
                sectors.erase(sector);
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
        let begin = slot * SLOT_BYTES;
        let is_good = self.sectors.write(begin, &record.bytes());
        let written = self.sectors.bytes().get(begin..begin + SLOT_BYTES);
        let is_stored = is_good && written.and_then(Record::of) == Some(record);
        if is_stored {
            self.newest = Some(record);
        }
        self.free = next_free(self.sectors.bytes(), Some(slot / SLOTS_PER_SECTOR));
        is_stored
    }
}

fn sector_range(sector: usize) -> core::ops::Range<usize> {
    sector * SLOTS_PER_SECTOR..(sector + 1) * SLOTS_PER_SECTOR
}

fn slot_bytes(bytes: &[u8], slot: usize) -> Option<&[u8]> {
    bytes.get(slot * SLOT_BYTES..(slot + 1) * SLOT_BYTES)
}

fn is_blank(bytes: &[u8], slots: core::ops::Range<usize>) -> bool {
    let range = slots.start * SLOT_BYTES..slots.end * SLOT_BYTES;
    bytes
        .get(range)
        .is_some_and(|bytes| bytes.iter().all(|byte| *byte == 0xff))
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
/// the first one of the other sector, if blank.
fn next_free(bytes: &[u8], in_use: Option<usize>) -> Option<usize> {
    let sector = in_use.unwrap_or(0);
    let range = sector_range(sector);
    let end = range.end;
    let used = range.rev().find(|slot| !is_blank(bytes, *slot..slot + 1));
    let next = used.map_or(sector_range(sector).start, |slot| slot + 1);
    if next < end {
        return Some(next);
    }
    let other = sector_range(1 - sector);
    is_blank(bytes, other.clone()).then_some(other.start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Flash: writing only clears bits; power may fail after some bytes.
    #[derive(Debug)]
    struct Ram<'a> {
        bytes: &'a mut Vec<u8>,
        power_for: usize,
        erased: usize,
    }

    impl Sectors for Ram<'_> {
        fn bytes(&self) -> &[u8] {
            self.bytes
        }

        fn write(&mut self, offset: usize, bytes: &[u8]) -> bool {
            for (place, byte) in self.bytes[offset..].iter_mut().zip(bytes) {
                if self.power_for == 0 {
                    return false;
                }
                self.power_for -= 1;
                assert_eq!(*place, 0xff, "written twice");
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
        ParameterLog::open(Ram {
            bytes,
            power_for: usize::MAX,
            erased: 0,
        })
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
    fn without_a_start_in_between_there_is_room_for_32_and_then_it_says_so() {
        let mut bytes = vec![0xff; LOG_BYTES];
        let mut log = open(&mut bytes);
        let kept = (1..=100).take_while(|n| log.store(Revision(*n), &values(*n)));
        assert_eq!(kept.count(), SLOTS);
        assert_eq!(log.sectors.erased, 0);
        let mut log = open(&mut bytes);
        assert_eq!(log.newest(), Some((Revision(32), values(32))));
        assert_eq!(log.sectors.erased, 1);
        assert!(log.store(Revision(33), &values(33)));
    }

    #[test]
    fn a_power_failure_at_any_byte_leaves_the_old_or_the_new() {
        let length = crate::parameter_record::RECORD_BYTES;
        for power_for in 0..=length {
            for before in [1, 15, 16, 17] {
                let mut bytes = vec![0xff; LOG_BYTES];
                for n in 1..=before {
                    assert!(open(&mut bytes).store(Revision(n), &values(n)));
                }
                let mut log = open(&mut bytes);
                log.sectors.power_for = power_for;
                let done = log.store(Revision(99), &values(99));
                assert_eq!(done, power_for == length);
                let expected = if done { 99 } else { before };
                let mut log = open(&mut bytes);
                assert_eq!(log.newest(), Some((Revision(expected), values(expected))));
                assert!(log.store(Revision(100), &values(100)));
            }
        }
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

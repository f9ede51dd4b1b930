//! The parameters that comms stores: as many records as the log in its flash has
//! room for.
//!
//! The log is two sectors of 16 slots. A start erases the sector that does not
//! hold the newest record, so a program saves 16 to 32 times without a start.

use crepitus_protocol::{Revision, Values};

/// Slots of a sector.
const SECTOR: usize = 16;

/// Parameters that last over a restart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Storage {
    newest: Option<(Revision, Values)>,
    /// The slot of the newest record.
    slot: usize,
    /// Slots that are left until the next start.
    free: usize,
    works: bool,
}

impl Storage {
    /// The log with this record alone, or an empty one.
    pub(crate) fn new(newest: Option<(Revision, Values)>) -> Self {
        let used = usize::from(newest.is_some());
        Self {
            newest,
            slot: 0,
            free: 2 * SECTOR - used,
            works: true,
        }
    }

    /// The parameters stored last.
    pub(crate) fn newest(&self) -> Option<(Revision, Values)> {
        self.newest
    }

    /// Whether writing works.
    pub(crate) fn set_works(&mut self, works: bool) {
        self.works = works;
    }

    /// Stores parameters; false if writing fails, or there is no room.
    pub(crate) fn store(&mut self, parameters: (Revision, Values)) -> bool {
        if !self.works || self.free == 0 {
            return false;
        }
        self.slot = if self.newest.is_some() {
            (self.slot + 1) % (2 * SECTOR)
        } else {
            0
        };
        self.free -= 1;
        self.newest = Some(parameters);
        true
    }

    /// Comms starts.
    pub(crate) fn start(&mut self) {
        if self.newest.is_some() {
            self.free = SECTOR - 1 - self.slot % SECTOR + SECTOR;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_makes_room_in_the_other_sector() {
        let parameters = (Revision(7), Values::default());
        let saves = |storage: &mut Storage| (0..100).filter(|_| storage.store(parameters)).count();
        let mut storage = Storage::new(None);
        assert_eq!(saves(&mut storage), 32);
        // The newest record is the last of its sector.
        storage.start();
        assert_eq!(saves(&mut storage), 16);
        storage.start();
        assert!(storage.store(parameters));
        storage.start();
        assert_eq!(saves(&mut storage), 15 + 16);
        assert_eq!(storage.newest(), Some(parameters));
        storage.start();
        storage.set_works(false);
        assert!(!storage.store(parameters));
    }
}

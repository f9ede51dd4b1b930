//! The parameters that comms stores: the firmware's own log, in flash.

use crate::nor_flash::NorFlash;
use crepitus_device::parameter_log::ParameterLog;
use crepitus_protocol::{Revision, Values};

/// Parameters that last over a restart.
#[derive(Debug)]
pub(crate) struct Storage {
    log: ParameterLog<NorFlash>,
    works: bool,
}

impl Storage {
    /// The log with this record alone, or an empty one.
    pub(crate) fn new(newest: Option<(Revision, Values)>) -> Self {
        let mut storage = Self {
            log: ParameterLog::open(NorFlash::default()),
            works: true,
        };
        if let Some(parameters) = newest {
            storage.store(parameters);
        }
        storage
    }

    /// The parameters stored last.
    pub(crate) fn newest(&self) -> Option<(Revision, Values)> {
        self.log.newest()
    }

    /// Returns whether writing works.
    pub(crate) fn set_works(&mut self, works: bool) {
        self.works = works;
    }

    /// Stores parameters; false if writing fails, or there is no room.
    pub(crate) fn store(&mut self, (revision, values): (Revision, Values)) -> bool {
        self.works && self.log.store(revision, &values)
    }

    /// Comms starts.
    pub(crate) fn start(&mut self) {
        let mut flash = self.log.sectors().clone();
        flash.restart();
        self.log = ParameterLog::open(flash);
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
        assert_eq!(saves(&mut storage), 14);
        // The newest record is the last of its sector.
        storage.start();
        assert_eq!(saves(&mut storage), 7);
        storage.start();
        assert!(storage.store(parameters));
        storage.start();
        assert_eq!(saves(&mut storage), 6 + 7);
        assert_eq!(storage.newest(), Some(parameters));
        storage.start();
        storage.set_works(false);
        assert!(!storage.store(parameters));
    }
}

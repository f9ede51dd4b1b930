//! Sectors 2 and 3 of flash, for parameters.

use crepitus_device::parameter_log::{LOG_BYTES, SECTOR_BYTES, Sectors};
use stm32f4xx_hal::flash::FlashExt;
use stm32f4xx_hal::pac::FLASH;

/// Start of the sectors; `comms/memory.x` excludes them from the program.
const OFFSET: usize = 2 * SECTOR_BYTES;

/// Number of the first sector.
const FIRST: u8 = 2;

/// The two sectors.
pub struct ParameterSectors(FLASH);

impl ParameterSectors {
    /// The sectors of this chip.
    pub fn new(flash: FLASH) -> Self {
        Self(flash)
    }

    /// Clears error flags, which would be taken for those of the next
    /// operation.
    fn clear_errors(&mut self) {
        self.0.sr().write(|w| {
            w.operr().clear().wrperr().clear().pgaerr().clear();
            w.pgperr().clear().pgserr().clear()
        });
    }

    /// Resets the data cache, which may hold the old content.
    fn reset_data_cache(&mut self) {
        let acr = self.0.acr();
        acr.modify(|_, w| w.dcen().clear_bit());
        acr.modify(|_, w| w.dcrst().set_bit());
        acr.modify(|_, w| w.dcrst().clear_bit());
        acr.modify(|_, w| w.dcen().set_bit());
    }
}

impl Sectors for ParameterSectors {
    fn bytes(&self) -> &[u8] {
        self.0
            .read()
            .get(OFFSET..OFFSET + LOG_BYTES)
            .unwrap_or_default()
    }

    fn write(&mut self, offset: usize, bytes: &[u8]) -> bool {
        if offset + bytes.len() > LOG_BYTES {
            return false;
        }
        self.clear_errors();
        let done = self
            .0
            .unlocked()
            .program(OFFSET + offset, bytes.iter())
            .is_ok();
        self.reset_data_cache();
        done
    }

    fn erase(&mut self, sector: usize) -> bool {
        let Some(number) = u8::try_from(sector).ok().filter(|sector| *sector < 2) else {
            return false;
        };
        self.clear_errors();
        let done = self.0.unlocked().erase(FIRST + number).is_ok();
        self.reset_data_cache();
        done
    }
}

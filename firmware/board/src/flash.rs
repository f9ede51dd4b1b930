//! Sectors 2 and 3 of flash, for parameters.

use crate::parameter_log::{LOG_BYTES, SECTOR_BYTES, Sectors};
use stm32f4xx_hal::flash::FlashExt;
use stm32f4xx_hal::pac::FLASH;

/// Where they begin; `comms/memory.x` keeps the program off them.
const OFFSET: usize = 2 * SECTOR_BYTES;

/// The number of the first.
const FIRST: u8 = 2;

/// The two sectors.
pub struct ParameterSectors(FLASH);

impl ParameterSectors {
    /// Of this chip.
    pub fn new(flash: FLASH) -> Self {
        Self(flash)
    }

    /// Errors stay until they are cleared, and would be taken for those of
    /// what is done next.
    fn forget_errors(&mut self) {
        self.0.sr().write(|w| {
            w.operr().clear().wrperr().clear().pgaerr().clear();
            w.pgperr().clear().pgserr().clear()
        });
    }

    /// The cache may still have what was there before.
    fn forget_cached(&mut self) {
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
        self.forget_errors();
        let done = self
            .0
            .unlocked()
            .program(OFFSET + offset, bytes.iter())
            .is_ok();
        self.forget_cached();
        done
    }

    fn erase(&mut self, sector: usize) -> bool {
        let Some(number) = u8::try_from(sector).ok().filter(|sector| *sector < 2) else {
            return false;
        };
        self.forget_errors();
        let done = self.0.unlocked().erase(FIRST + number).is_ok();
        self.forget_cached();
        done
    }
}

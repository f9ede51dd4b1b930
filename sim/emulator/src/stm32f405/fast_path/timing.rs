//! Waits for flash of plain instructions, if they are modelled.

use crate::chip::waits::Waits;
use crate::image::{FLASH, FLASH_BYTES};

/// The most words that an instruction reads.
const MOST: usize = 32;

/// Requests to the flash interface, made when the instruction is certain.
pub(super) struct Timing<'a> {
    /// None: flash never makes the core wait.
    waits: Option<&'a Waits>,
    /// The cycle in which the run has begun.
    clock: u64,
    /// Offsets of the data that this instruction reads.
    data: [u32; MOST],
    count: usize,
}

impl<'a> Timing<'a> {
    pub(super) fn new(waits: &'a Waits, clock: u64) -> Self {
        Self {
            waits: waits.is_on().then_some(waits),
            clock,
            data: [0; MOST],
            count: 0,
        }
    }

    /// This instruction reads data at an address. `None` if the library reads it in
    /// pieces.
    #[inline]
    pub(super) fn data(&mut self, address: u32, bytes: u32) -> Option<()> {
        let offset = address.wrapping_sub(FLASH);
        if self.waits.is_none() || offset as usize >= FLASH_BYTES {
            return Some(());
        }
        if !address.is_multiple_of(bytes) {
            return None;
        }
        *self.data.get_mut(self.count)? = offset;
        self.count += 1;
        Some(())
    }

    /// The waits of an instruction that was executed, so many cycles after the begin.
    #[inline]
    pub(super) fn instruction(&mut self, begin: u64, pc: u32, width: u32) -> u64 {
        let Some(waits) = self.waits else { return 0 };
        let fetched = (pc.wrapping_sub(FLASH)..)
            .step_by(2)
            .take((width / 2) as usize);
        let data = self.data.iter().take(self.count).copied();
        let cycles = waits.step(self.clock + begin, fetched, data);
        self.count = 0;
        cycles
    }
}

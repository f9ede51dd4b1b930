//! NOR flash whose power fails: the two sectors of the parameters.
//!
//! Of a byte that was cut off some bits are programmed. A sector that is
//! erased is first programmed to zero, then its bits turn to one in no order; one
//! that was cut off near its end reads as erased at the next start, and no longer
//! at the one after: its cells are marginal until it is erased whole. How far an
//! operation has come decides, and nothing random. The image's flash in the emulator
//! does the same.

mod cut;

use crepitus_device::parameter_log::{LOG_BYTES, SECTOR_BYTES, Sectors};
pub use cut::{Cut, Marginal, WHOLE};
use std::ops::Range;

/// Moments of a byte's programming at which power may fail.
pub const WRITE_STEPS: u32 = 4;

/// Moments of an erasure.
pub const ERASE_STEPS: u32 = 64;

/// The two sectors.
#[derive(Clone, Debug)]
pub struct NorFlash {
    bytes: Vec<u8>,
    marginal: [Marginal; 2],
    /// Moments until power fails.
    power: Option<u32>,
}

impl Default for NorFlash {
    /// Returns a flash as it comes from the factory.
    fn default() -> Self {
        Self {
            bytes: vec![0xff; LOG_BYTES],
            marginal: [Marginal::default(); 2],
            power: None,
        }
    }
}

fn range(sector: usize) -> Range<usize> {
    sector * SECTOR_BYTES..(sector + 1) * SECTOR_BYTES
}

impl NorFlash {
    /// Power fails after this many moments.
    pub fn fail_after(&mut self, moments: u32) {
        self.power = Some(moments);
    }

    /// Returns whether power has failed.
    pub fn is_off(&self) -> bool {
        self.power == Some(0)
    }

    /// Power is back.
    pub fn restart(&mut self) {
        self.power = None;
        for (sector, marginal) in self.marginal.iter_mut().enumerate() {
            let range = range(sector);
            marginal.start(range.start, &mut self.bytes[range]);
        }
    }

    /// Spends the moments of an operation; how far it has come, if power fails.
    fn spend(&mut self, moments: u32) -> Option<Cut> {
        let left = self.power.as_mut()?;
        if *left > moments {
            *left -= moments;
            return None;
        }
        let done = std::mem::take(left);
        Some(Cut::at(u64::from(done), u64::from(moments)))
    }
}

impl Sectors for NorFlash {
    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn write(&mut self, offset: usize, bytes: &[u8]) -> bool {
        for (at, byte) in (offset..).zip(bytes) {
            if self.is_off() {
                return false;
            }
            match self.spend(WRITE_STEPS) {
                Some(cut) => cut.program(at, &mut self.bytes[at..=at], &[*byte]),
                None => self.bytes[at] &= byte,
            }
        }
        !self.is_off()
    }

    fn erase(&mut self, sector: usize) -> bool {
        if self.is_off() {
            return false;
        }
        let range = range(sector);
        let cut = self.spend(ERASE_STEPS);
        let bytes = &mut self.bytes[range.clone()];
        match cut {
            Some(cut) => cut.erase(range.start, bytes),
            None => bytes.fill(0xff),
        }
        self.marginal[sector] = Marginal::after(cut);
        cut.is_none()
    }
}

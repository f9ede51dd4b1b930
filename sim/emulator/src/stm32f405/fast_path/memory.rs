//! Memory that a plain instruction may touch.

use crate::chip::Chip;
use crate::chip::memory::{CCM, CCM_BYTES, Memory, RAM, RAM_BYTES};
use crate::devices::flash::Flash;
use crate::image::{FLASH, FLASH_BYTES};
use rsemu::core::space::RamStore;
use rsemu::core::value::{Endian, Width};
use std::sync::Arc;

/// RAM and flash at their addresses.
pub(super) struct Windows {
    ram: Arc<RamStore>,
    ccm: Arc<RamStore>,
    flash: Arc<RamStore>,
    controller: Arc<Flash>,
}

const fn width(bytes: u32) -> Width {
    match bytes {
        1 => Width::U8,
        2 => Width::U16,
        _ => Width::U32,
    }
}

/// Offset in a memory of so many bytes, if the access is in it.
#[inline]
fn offset(address: u32, bytes: u32, base: u32, size: u64) -> Option<u64> {
    let offset = u64::from(address.wrapping_sub(base));
    (offset + u64::from(bytes) <= size).then_some(offset)
}

impl Windows {
    pub(super) fn new(chip: &Chip, memory: &Memory) -> Self {
        Self {
            ram: memory.ram.clone(),
            ccm: memory.ccm.clone(),
            flash: chip.flash.array(),
            controller: chip.flash.clone(),
        }
    }

    /// The memory that can be written at an address, and the offset in it.
    #[inline]
    fn writable(&self, address: u32, bytes: u32) -> Option<(&RamStore, u64)> {
        if let Some(offset) = offset(address, bytes, RAM, RAM_BYTES) {
            return Some((&self.ram, offset));
        }
        let offset = offset(address, bytes, CCM, CCM_BYTES)?;
        Some((&self.ccm, offset))
    }

    #[inline]
    pub(super) fn is_writable(&self, address: u32, bytes: u32) -> bool {
        self.writable(address, bytes).is_some()
    }

    /// A value of 1, 2 or 4 bytes; `None` where there is no memory.
    #[inline]
    pub(super) fn read(&self, address: u32, bytes: u32) -> Option<u32> {
        let in_flash = || {
            let offset = offset(address, bytes, FLASH, FLASH_BYTES as u64)?;
            self.controller.load(offset, bytes as usize);
            Some((&*self.flash, offset))
        };
        let (memory, offset) = self.writable(address, bytes).or_else(in_flash)?;
        let value = memory.read_value(offset, width(bytes), Endian::Little);
        u32::try_from(value.ok()?).ok()
    }

    #[inline]
    pub(super) fn write(&self, address: u32, bytes: u32, value: u32) -> Option<()> {
        let (memory, offset) = self.writable(address, bytes)?;
        let value = u64::from(value);
        let written = memory.write_value(offset, width(bytes), value, Endian::Little);
        written.ok()
    }
}

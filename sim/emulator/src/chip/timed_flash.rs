//! Flash that counts the waits of its readers, mapped in front of it.

use super::waits::Waits;
use rsemu::core::error::BusError;
use rsemu::core::space::{
    AccessConstraints, AccessPurpose, AddressSpace, MemAttrs, MemOps, MemResult,
};
use rsemu::core::value::Width;
use std::sync::Arc;

#[derive(Debug)]
pub(crate) struct TimedFlash {
    /// Flash alone, from address 0.
    array: AddressSpace,
    waits: Arc<Waits>,
}

impl TimedFlash {
    pub(crate) fn new(array: AddressSpace, waits: Arc<Waits>) -> Self {
        Self { array, waits }
    }
}

impl MemOps for TimedFlash {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        if !attrs.debug {
            let offset = u32::try_from(offset).map_err(|_| BusError::Unassigned)?;
            let is_fetch = attrs.purpose == AccessPurpose::FETCH;
            self.waits.flash(offset, is_fetch);
        }
        self.array.read_bytes(offset, into, attrs)
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        // A flash controller checks the width of what is written.
        let width = match from.len() {
            1 => Width::U8,
            2 => Width::U16,
            _ => Width::U32,
        };
        let value = from
            .iter()
            .rev()
            .fold(0, |all, byte| all << 8 | u64::from(*byte));
        self.array.write(offset, width, value, attrs)
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::ANY
    }
}

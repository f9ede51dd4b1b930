//! RAM that writes down who accesses it.

use crate::chip::part::lock;
use rsemu::core::error::BusError;
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, RamStore};
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// A window of RAM, mapped in front of it.
#[derive(Debug)]
pub(crate) struct ObservedRam {
    ram: Arc<RamStore>,
    /// Address of the RAM.
    base: u32,
    ranges: Mutex<Vec<Range<u32>>>,
    accesses: Mutex<Vec<(u32, bool)>>,
}

impl ObservedRam {
    pub(crate) fn new(ram: Arc<RamStore>, base: u32) -> Self {
        Self {
            ram,
            base,
            ranges: Mutex::default(),
            accesses: Mutex::default(),
        }
    }

    /// Writes down accesses to these addresses from now on.
    pub(crate) fn observe(&self, ranges: &[Range<u32>]) {
        *lock(&self.ranges) = ranges.to_vec();
    }

    /// Takes the accesses since the last call: address, whether it was a write.
    pub(crate) fn take(&self) -> Vec<(u32, bool)> {
        std::mem::take(&mut *lock(&self.accesses))
    }

    fn note(&self, offset: u64, bytes: usize, is_write: bool, attrs: MemAttrs) {
        let begin = self
            .base
            .saturating_add(u32::try_from(offset).unwrap_or(u32::MAX));
        let end = begin.saturating_add(u32::try_from(bytes).unwrap_or(u32::MAX));
        let is_in = |range: &Range<u32>| begin < range.end && range.start < end;
        if !attrs.debug && lock(&self.ranges).iter().any(is_in) {
            lock(&self.accesses).push((begin, is_write));
        }
    }
}

impl MemOps for ObservedRam {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        self.note(offset, into.len(), false, attrs);
        let read = self.ram.read_at(offset, into);
        read.map_err(|_| BusError::Unassigned)
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        self.note(offset, from.len(), true, attrs);
        let written = self.ram.write_at(offset, from);
        written.map_err(|_| BusError::Unassigned)
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::ANY
    }
}

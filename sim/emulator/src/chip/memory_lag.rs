//! Bytes that a DMA stream has counted, and that are not in memory yet.
//!
//! NDTR counts down when a byte is read from the peripheral, some clocks before it is written to memory. Modelled
//! from the other end: the core reads the NDTR that there will be so many clocks later.

use std::fmt;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// NDTR of stream 1 of DMA2, which receives for USART6.
const NDTR: u32 = 0x4002_642c;

/// Time of the next byte that the stream moves, in units.
type Arrival = dyn Fn() -> Option<u64> + Send + Sync;

/// The lag; none unless it is set.
#[derive(Default)]
pub(crate) struct MemoryLag {
    units: AtomicU64,
    next_arrival: OnceLock<Box<Arrival>>,
}

impl fmt::Debug for MemoryLag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MemoryLag").finish_non_exhaustive()
    }
}

impl MemoryLag {
    /// Sets what says when the device that the stream serves has its next byte.
    pub(crate) fn of(&self, next_arrival: Box<Arrival>) {
        // Set once, by the chip.
        let _ = self.next_arrival.set(next_arrival);
    }

    /// Sets the lag, in units of time.
    pub(crate) fn set(&self, units: u64) {
        self.units.store(units, Relaxed);
    }

    /// The value of a register as the core reads it.
    pub(crate) fn seen(&self, address: u32, value: u32, now: u64) -> u32 {
        let units = self.units.load(Relaxed);
        if address != NDTR || units == 0 {
            return value;
        }
        let arrival = self.next_arrival.get().and_then(|next| next());
        let is_counted = arrival.is_some_and(|at| at <= now + units);
        // At its end it begins anew: that byte is left as it is.
        if is_counted && value > 1 {
            value - 1
        } else {
            value
        }
    }
}

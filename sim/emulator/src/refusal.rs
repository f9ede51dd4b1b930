//! Uses of the chip that its reference manual forbids, and that silicon answers with wrong data or
//! not at all. The first one stops the core for good: no later result of the run means anything.

use std::sync::OnceLock;

/// A use of the chip that stops the emulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// A load from a line of the data cache that an erasure has left behind.
    #[error(
        "the core loads {address:#010x} from a line of the data cache that is older than the \
         erasure of its sector: reset the data cache after an erasure (RM0090 3.6.3)"
    )]
    StaleData {
        /// Address of the load.
        address: u32,
    },
    /// A reset of the data cache while it is enabled.
    #[error(
        "DCRST is set while the data cache is enabled, so nothing is reset: clear DCEN first \
         (RM0090 3.6.3)"
    )]
    CacheResetWhileEnabled,
    /// A stream of a DMA controller that is enabled with event flags of the transfer before.
    #[error(
        "stream {stream} of DMA{controller} is enabled with event flags still set ({flags:#04x}): \
         clear them first, or it does not start (RM0090 10.5.5)"
    )]
    StreamFlags {
        /// Controller, from 1 on.
        controller: u8,
        /// Stream, from 0 on.
        stream: u8,
        /// Flags of the stream as in `DMA_LISR`, shifted to the lowest bit.
        flags: u32,
    },
}

/// The first refusal of a chip.
#[derive(Debug, Default)]
pub(crate) struct Refusals(OnceLock<Refusal>);

impl Refusals {
    /// Stores a refusal, unless there has been one.
    #[cold]
    pub(crate) fn refuse(&self, refusal: Refusal) {
        // A later one may be a consequence of the first.
        let _ = self.0.set(refusal);
    }

    /// The first refusal.
    pub(crate) fn first(&self) -> Option<Refusal> {
        self.0.get().copied()
    }
}

//! The time of a full-speed bus: 12 Mbit/s in frames of 1 ms.

/// A frame of a full-speed bus, bytes: 12 Mbit/s for 1 ms.
const FRAME_BYTES: usize = 1_500;
/// Overhead of a bulk transaction besides its data, bytes (USB 2.0, table 5-9).
const TRANSACTION_OVERHEAD: usize = 13;

/// Rest of a frame, in bytes. A NAK takes no time: a real host repeats it only in unused
/// time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameTime {
    bytes_left: usize,
}

impl FrameTime {
    /// Starts a new frame.
    pub(crate) fn start(&mut self) {
        self.bytes_left = FRAME_BYTES;
    }

    /// Returns whether a transaction with this much data still fits, bytes.
    pub(crate) fn has_room_for(self, data: usize) -> bool {
        data + TRANSACTION_OVERHEAD <= self.bytes_left
    }

    /// Takes the time of a transaction with this much data, bytes.
    pub(crate) fn spend(&mut self, data: usize) {
        self.bytes_left = self.bytes_left.saturating_sub(data + TRANSACTION_OVERHEAD);
    }
}

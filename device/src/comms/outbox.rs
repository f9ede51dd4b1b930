//! The transmit queue to the host.
//!
//! A frame is queued whole or dropped. Some room is reserved for replies, so a
//! host that reads slowly still gets them.

use crate::comms::byte_ring::ByteRing;
use crepitus_protocol::frame::{DELIMITER, FRAME_BYTES};

/// Capacity in bytes: 38 ms of telemetry beside the room for replies.
pub const OUTBOX_BYTES: usize = 16_384;

/// Bytes reserved for replies.
const REPLY_BYTES: usize = 2 * FRAME_BYTES;

/// The queue.
#[derive(Debug)]
pub struct Outbox {
    bytes: ByteRing<OUTBOX_BYTES>,
}

impl Default for Outbox {
    /// A queue that begins with a delimiter, so that the host's decoder
    /// resynchronises.
    fn default() -> Self {
        let mut outbox = Self {
            bytes: ByteRing::new(),
        };
        outbox.clear();
        outbox
    }
}

impl Outbox {
    /// Clears the queue: the host is gone.
    pub fn clear(&mut self) {
        self.bytes.clear();
        // There is room: the queue is empty.
        let _ = self.bytes.push(&[DELIMITER]);
    }

    /// Queues a reply; false if there is no room.
    pub fn reply(&mut self, frame: &[u8]) -> bool {
        self.push(frame, 0)
    }

    /// Queues telemetry; false if only the room for replies is left.
    pub fn telemetry(&mut self, frame: &[u8]) -> bool {
        self.push(frame, REPLY_BYTES)
    }

    fn push(&mut self, frame: &[u8], reserved: usize) -> bool {
        let room = OUTBOX_BYTES
            .saturating_sub(self.bytes.len())
            .saturating_sub(reserved);
        frame.len() <= room && self.bytes.push(frame)
    }

    /// The next bytes to send, contiguous.
    pub fn to_send(&self) -> &[u8] {
        self.bytes.front()
    }

    /// Removes the first `count` bytes: they were sent.
    pub fn sent(&mut self, count: usize) {
        self.bytes.drop_front(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn telemetry_leaves_room_for_replies() {
        let mut outbox = Outbox::default();
        assert_eq!(outbox.to_send(), [0]);
        let frame = [7; 380];
        let mut queued = 0;
        while outbox.telemetry(&frame) {
            queued += 1;
        }
        assert!(queued >= 37, "{queued}");
        assert!(outbox.reply(&frame) && outbox.reply(&frame));
        while outbox.reply(&frame) {}
        let mut bytes = 0;
        while !outbox.to_send().is_empty() {
            let run = outbox.to_send().len().min(64);
            bytes += run;
            outbox.sent(run);
        }
        assert!(
            bytes <= OUTBOX_BYTES && bytes % 380 == 1,
            "whole frames only"
        );
        outbox.sent(1);
        outbox.clear();
        assert_eq!(outbox.to_send(), [0]);
    }
}

//! The transmit queue to the host.
//!
//! A frame is queued whole or dropped. Some room is reserved for replies, so a
//! host that reads slowly still gets them.

use crepitus_protocol::frame::{DELIMITER, FRAME_BYTES, Frame};

/// Capacity in bytes: 48 ms of telemetry.
pub const OUTBOX_BYTES: usize = 16_384;

/// Bytes reserved for replies.
const REPLY_BYTES: usize = 2 * FRAME_BYTES;

/// A ring buffer of bytes.
#[derive(Debug)]
pub struct Outbox {
    bytes: heapless::Deque<u8, OUTBOX_BYTES>,
}

impl Default for Outbox {
    /// A queue that begins with a delimiter, so that the host's decoder
    /// resynchronises.
    fn default() -> Self {
        let mut outbox = Self {
            bytes: heapless::Deque::new(),
        };
        outbox.clear();
        outbox
    }
}

impl Outbox {
    /// Clears the queue: the host is gone.
    pub fn clear(&mut self) {
        self.bytes.clear();
        // Cannot fail: the queue is empty.
        let _ = self.bytes.push_back(DELIMITER);
    }

    /// Queues a reply; false if there is no room.
    pub fn reply(&mut self, frame: &Frame) -> bool {
        self.push(frame, 0)
    }

    /// Queues telemetry; false if only the room for replies is left.
    pub fn telemetry(&mut self, frame: &Frame) -> bool {
        self.push(frame, REPLY_BYTES)
    }

    fn push(&mut self, frame: &Frame, reserved: usize) -> bool {
        let room = OUTBOX_BYTES
            .saturating_sub(self.bytes.len())
            .saturating_sub(reserved);
        let fits = frame.len() <= room;
        if fits {
            for byte in frame {
                // Checked above; unlike `extend`, `push_back` does not panic.
                let _ = self.bytes.push_back(*byte);
            }
        }
        fits
    }

    /// The next bytes to send, contiguous.
    pub fn to_send(&self) -> &[u8] {
        self.bytes.as_slices().0
    }

    /// Removes the first `count` bytes: they were sent.
    pub fn sent(&mut self, count: usize) {
        for _ in 0..count {
            self.bytes.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn telemetry_leaves_room_for_replies() {
        let mut outbox = Outbox::default();
        assert_eq!(outbox.to_send(), [0]);
        let frame = Frame::from_slice(&[7; 340]).unwrap();
        let mut queued = 0;
        while outbox.telemetry(&frame) {
            queued += 1;
        }
        assert!(queued >= 44, "{queued}");
        assert!(outbox.reply(&frame) && outbox.reply(&frame));
        while outbox.reply(&frame) {}
        let mut bytes = 0;
        while !outbox.to_send().is_empty() {
            let run = outbox.to_send().len().min(64);
            bytes += run;
            outbox.sent(run);
        }
        assert!(
            bytes <= OUTBOX_BYTES && bytes % 340 == 1,
            "whole frames only"
        );
        outbox.sent(1);
        outbox.clear();
        assert_eq!(outbox.to_send(), [0]);
    }
}

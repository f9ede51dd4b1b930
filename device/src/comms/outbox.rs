//! The queue of bytes to the host.
//!
//! Frames go in whole or not at all. Replies keep some room for themselves, so
//! a host that reads slowly still gets its answers.

use crepitus_protocol::frame::{DELIMITER, FRAME_BYTES, Frame};

/// Bytes that may wait for the host: 48 ms of telemetry.
pub const OUTBOX_BYTES: usize = 16_384;

/// Room that only replies may use.
const REPLY_BYTES: usize = 2 * FRAME_BYTES;

/// The queue.
#[derive(Debug)]
pub struct Outbox {
    bytes: heapless::Deque<u8, OUTBOX_BYTES>,
}

impl Default for Outbox {
    /// A queue that begins with a delimiter: whatever the host has received
    /// before, its decoder starts anew.
    fn default() -> Self {
        let mut outbox = Self {
            bytes: heapless::Deque::new(),
        };
        outbox.restart();
        outbox
    }
}

impl Outbox {
    /// Throws away what waits: the host has gone.
    pub fn restart(&mut self) {
        self.bytes.clear();
        // An empty queue has room for a byte.
        let _ = self.bytes.push_back(DELIMITER);
    }

    /// Queues a reply, if there is room.
    pub fn reply(&mut self, frame: &Frame) -> bool {
        self.push(frame, 0)
    }

    /// Queues telemetry, if there is room beside that for replies.
    pub fn telemetry(&mut self, frame: &Frame) -> bool {
        self.push(frame, REPLY_BYTES)
    }

    fn push(&mut self, frame: &Frame, kept: usize) -> bool {
        let room = OUTBOX_BYTES
            .saturating_sub(self.bytes.len())
            .saturating_sub(kept);
        let fits = frame.len() <= room;
        if fits {
            for byte in frame {
                // There is room; unlike `extend` this does not panic without.
                let _ = self.bytes.push_back(*byte);
            }
        }
        fits
    }

    /// What is to be sent next, in one run.
    pub fn to_send(&self) -> &[u8] {
        self.bytes.as_slices().0
    }

    /// The first `count` of them are sent.
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
        outbox.restart();
        assert_eq!(outbox.to_send(), [0]);
    }
}

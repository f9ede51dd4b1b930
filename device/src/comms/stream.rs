//! The stream of blocks to the host, with the count of samples that were not
//! sent. There is one for all sessions; each knows where it has joined.

use crate::comms::outbox::Outbox;
use crepitus_protocol::Lane;
use crepitus_protocol::frame::{self, FRAME_BYTES};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};

/// The stream of blocks to the host.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stream {
    /// The tick from which on it counts.
    first_tick: u64,
    /// Samples that were queued to the host.
    forwarded: u64,
}

impl Stream {
    /// Starts at this tick: that of the drive's first block.
    pub fn new(first_tick: u64) -> Self {
        Self {
            first_tick,
            forwarded: 0,
        }
    }

    /// Samples before this tick that were not sent, for any reason; wraps.
    pub fn dropped_before(&self, tick: u64) -> u32 {
        let elapsed = tick.saturating_sub(self.first_tick);
        let [a, b, c, d, ..] = elapsed.saturating_sub(self.forwarded).to_le_bytes();
        u32::from_le_bytes([a, b, c, d])
    }

    /// Queues a block with the count of samples that were not sent; false if
    /// there is no room.
    pub fn forward(&mut self, block: &Block, outbox: &mut Outbox) -> bool {
        let block = Block {
            dropped: self.dropped_before(block.first_tick),
            ..*block
        };
        let mut buffer = [0; FRAME_BYTES];
        let frame = frame::encode_in(&mut buffer, Lane::Telemetry, &block);
        let queued = frame.is_ok_and(|frame| outbox.telemetry(frame));
        if queued {
            self.forwarded = self.forwarded.saturating_add(BLOCK_SAMPLES as u64);
        }
        queued
    }
}

//! Telemetry for the host, with the count of dropped samples.

use crate::comms::outbox::Outbox;
use crepitus_protocol::Lane;
use crepitus_protocol::frame;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};

/// A subscription to telemetry.
#[derive(Clone, Copy, Debug)]
pub struct Subscription {
    first_tick: u64,
    /// Samples that were queued to the host.
    forwarded: u64,
}

impl Subscription {
    /// Starts at this tick.
    pub fn new(first_tick: u64) -> Self {
        Self {
            first_tick,
            forwarded: 0,
        }
    }

    /// Restarts the accounting after a restart of the drive.
    pub fn rebase(&mut self, first_tick: u64) {
        *self = Self::new(first_tick);
    }

    /// First tick of the subscription.
    pub fn first_tick(&self) -> u64 {
        self.first_tick
    }

    /// Queues a block with the total of samples lost before it, at any stage;
    /// false if there is no room.
    pub fn forward(&mut self, block: &Block, outbox: &mut Outbox) -> bool {
        let elapsed = block.first_tick.saturating_sub(self.first_tick);
        let dropped = elapsed.saturating_sub(self.forwarded);
        let [a, b, c, d, ..] = dropped.to_le_bytes();
        let block = Block {
            // The counter wraps.
            dropped: u32::from_le_bytes([a, b, c, d]),
            ..*block
        };
        let queued =
            frame::encode(Lane::Telemetry, &block).is_ok_and(|frame| outbox.telemetry(&frame));
        if queued {
            self.forwarded = self.forwarded.saturating_add(BLOCK_SAMPLES as u64);
        }
        queued
    }
}

//! Accounting of telemetry samples: produced, received, dropped, lost.
//!
//! ```text
//! drive ──> comms ──> connection ──> this client
//!   produced   └ dropped by the device     └ received
//!                        └ lost on the connection
//!
//! produced = received + dropped by the device + lost on the connection
//! ```
//!
//! Each block carries the number of samples that the device has not sent so far,
//! and the answer to the subscription those before it; so all others that are missing were lost between the device and here. The
//! sums are exact up to the last block received.
//!
//! When the drive restarts, its ticks restart, and a new *segment* begins; the
//! sums continue. Blocks lost after a restart and before the first received one
//! cannot be detected here and are not counted.

use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use std::collections::VecDeque;

/// Number of gaps stored.
const GAPS: usize = 1_000;

const SAMPLES: u64 = BLOCK_SAMPLES as u64;

/// Consecutive missing samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Tick of the first one.
    pub first_tick: u64,
    /// Number of samples.
    pub samples: u64,
}

/// Relation of a block to the stream before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// A new block.
    Next {
        /// Samples missing before it.
        missing: u64,
    },
    /// The first block after a restart of the drive.
    Restarted {
        /// Samples missing before it.
        missing: u64,
    },
    /// A repeated block, or one older than the last.
    Old,
}

/// Sample accounting of a subscription.
#[derive(Clone, Debug)]
pub struct Accounting {
    /// Sums of the previous segments.
    produced: u64,
    received: u64,
    dropped: u64,
    segment: Segment,
    gaps: VecDeque<Gap>,
    gap_count: u64,
    restarts: u64,
    old: u64,
    violations: u64,
}

/// Start of a stream of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Begin {
    /// The first tick.
    pub first_tick: u64,
    /// Samples before it that the device has not sent.
    pub dropped: u32,
    /// The drive's start that counts them, as in the flags of its blocks.
    pub start: u8,
}

/// Sums since the subscription started, or the drive restarted.
#[derive(Clone, Copy, Debug)]
struct Segment {
    first_tick: u64,
    next_tick: u64,
    received: u64,
    /// Dropped by the device; unlike the counter in a block this does not wrap.
    dropped: u64,
    said: u32,
    start: u8,
}

impl Segment {
    fn new(begin: Begin) -> Self {
        Self {
            first_tick: begin.first_tick,
            next_tick: begin.first_tick,
            received: 0,
            dropped: 0,
            said: begin.dropped,
            start: begin.start,
        }
    }

    fn produced(&self) -> u64 {
        self.next_tick.saturating_sub(self.first_tick)
    }
}

impl Accounting {
    /// Starts here.
    pub fn new(begin: Begin) -> Self {
        Self {
            produced: 0,
            received: 0,
            dropped: 0,
            segment: Segment::new(begin),
            gaps: VecDeque::new(),
            gap_count: 0,
            restarts: 0,
            old: 0,
            violations: 0,
        }
    }

    /// Accounts for the next block.
    pub fn take(&mut self, block: &Block) -> Taken {
        let start = block.flags.start();
        let is_restart = self.segment.start != start;
        if is_restart {
            // The device restarts its accounting, too.
            self.resume(Begin {
                first_tick: block.first_tick.saturating_sub(u64::from(block.dropped)),
                dropped: 0,
                start,
            });
            self.restarts += 1;
        } else if block.first_tick < self.segment.next_tick {
            self.old += 1;
            return Taken::Old;
        }
        let segment = &mut self.segment;
        let missing = block.first_tick.saturating_sub(segment.next_tick);
        let gap = Gap {
            first_tick: segment.next_tick,
            samples: missing,
        };
        segment.next_tick = block.end_tick();
        segment.received += SAMPLES;
        segment.dropped += u64::from(block.dropped.wrapping_sub(segment.said));
        segment.said = block.dropped;
        // The device reports as dropped what has arrived here.
        if segment.received + segment.dropped > segment.produced() {
            self.violations += 1;
        }
        if missing > 0 {
            self.gap_count += 1;
            if self.gaps.len() == GAPS {
                self.gaps.pop_front();
            }
            self.gaps.push_back(gap);
        }
        if is_restart {
            Taken::Restarted { missing }
        } else {
            Taken::Next { missing }
        }
    }

    /// Resumes here after a lost connection. Samples produced in
    /// between are not counted.
    pub(crate) fn resume(&mut self, begin: Begin) {
        self.produced += self.segment.produced();
        self.received += self.segment.received;
        self.dropped += self.segment.dropped;
        self.segment = Segment::new(begin);
    }

    /// Samples produced for the subscription.
    pub fn produced(&self) -> u64 {
        self.produced + self.segment.produced()
    }

    /// Samples received.
    pub fn received(&self) -> u64 {
        self.received + self.segment.received
    }

    /// Samples missing, lost at any stage.
    pub fn dropped(&self) -> u64 {
        self.produced().saturating_sub(self.received())
    }

    /// Missing samples that the device dropped or lost on its own link.
    pub fn dropped_by_device(&self) -> u64 {
        self.dropped + self.segment.dropped
    }

    /// Missing samples that were lost between the device and here.
    pub fn lost_on_line(&self) -> u64 {
        self.dropped().saturating_sub(self.dropped_by_device())
    }

    /// The tick after the last sample received; initially the first tick of the
    /// subscription.
    pub fn next_tick(&self) -> u64 {
        self.segment.next_tick
    }

    /// The first tick of the subscription, or since the drive's restart.
    pub fn first_tick(&self) -> u64 {
        self.segment.first_tick
    }

    /// The last thousand gaps.
    pub fn gaps(&self) -> impl ExactSizeIterator<Item = &Gap> {
        self.gaps.iter()
    }

    /// Number of gaps.
    pub fn gap_count(&self) -> u64 {
        self.gap_count
    }

    /// Restarts of the drive.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    /// Repeated or late blocks.
    pub fn old_blocks(&self) -> u64 {
        self.old
    }

    /// Blocks with an inconsistent count: the device reports more dropped
    /// samples than are missing. A bug in its firmware.
    pub fn violations(&self) -> u64 {
        self.violations
    }
}

#[cfg(test)]
mod tests;

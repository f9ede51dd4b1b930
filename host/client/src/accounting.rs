//! The books of the telemetry: what was produced, what arrived, what was lost
//! and where.
//!
//! ```text
//! drive ──> comms ──> line ──> this client
//!   produced   └ dropped by the device     └ received
//!                        └ lost on the line
//!
//! produced = received + dropped by the device + lost on the line
//! ```
//!
//! Each block says how many samples of the subscription the device has dropped
//! so far, so what else is missing was lost between the device and here. Books
//! are exact up to the last block that arrived; what is lost after it shows
//! with the next one.
//!
//! Where the drive starts anew, ticks begin anew, and so does a *segment* of
//! the books; the sums go on. Blocks of the new start that are lost before its
//! first one arrives cannot be seen from here and are in no book.

use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use std::collections::VecDeque;

/// Gaps that are remembered.
const GAPS: usize = 1_000;

const SAMPLES: u64 = BLOCK_SAMPLES as u64;

/// Samples in a row that did not arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Tick of the first of them.
    pub first_tick: u64,
    /// How many.
    pub samples: u64,
}

/// What a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// The next one; so many samples are missing before it.
    Next {
        /// Missing samples.
        missing: u64,
    },
    /// The first one of another start of the drive; so many samples of that
    /// start are known to be missing before it.
    Restarted {
        /// Missing samples.
        missing: u64,
    },
    /// One that was here already, or one older than the last.
    Old,
}

/// The books of a subscription.
#[derive(Clone, Debug)]
pub struct Accounting {
    /// Sums of the segments before.
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

/// The books since the subscription began, or the drive did.
#[derive(Clone, Copy, Debug)]
struct Segment {
    first_tick: u64,
    next_tick: u64,
    received: u64,
    /// Dropped by the device; what a block says wraps, this does not.
    dropped: u64,
    said: u32,
    start: Option<u8>,
}

impl Segment {
    fn new(first_tick: u64, start: Option<u8>) -> Self {
        Self {
            first_tick,
            next_tick: first_tick,
            received: 0,
            dropped: 0,
            said: 0,
            start,
        }
    }

    fn produced(&self) -> u64 {
        self.next_tick.saturating_sub(self.first_tick)
    }
}

impl Accounting {
    /// Of a subscription that begins with this tick.
    pub fn new(first_tick: u64) -> Self {
        Self {
            produced: 0,
            received: 0,
            dropped: 0,
            segment: Segment::new(first_tick, None),
            gaps: VecDeque::new(),
            gap_count: 0,
            restarts: 0,
            old: 0,
            violations: 0,
        }
    }

    /// Takes the next block.
    pub fn take(&mut self, block: &Block) -> Taken {
        let start = block.flags.start();
        let is_restart = self.segment.start.is_some_and(|known| known != start);
        if is_restart {
            // The device has begun its books anew, too.
            let first_tick = block.first_tick.saturating_sub(u64::from(block.dropped));
            self.resume(first_tick);
            self.restarts += 1;
        } else if block.first_tick < self.segment.next_tick {
            self.old += 1;
            return Taken::Old;
        }
        let segment = &mut self.segment;
        segment.start = Some(start);
        let missing = block.first_tick.saturating_sub(segment.next_tick);
        let gap = Gap {
            first_tick: segment.next_tick,
            samples: missing,
        };
        segment.next_tick = block.end_tick();
        segment.received += SAMPLES;
        segment.dropped += u64::from(block.dropped.wrapping_sub(segment.said));
        segment.said = block.dropped;
        // The device says that it has dropped what has arrived here.
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

    /// Another subscription after a line that was lost: it begins with this
    /// tick. What was produced in between belongs to none.
    pub(crate) fn resume(&mut self, first_tick: u64) {
        self.produced += self.segment.produced();
        self.received += self.segment.received;
        self.dropped += self.segment.dropped;
        self.segment = Segment::new(first_tick, None);
    }

    /// Samples that the drive has produced for the subscription.
    pub fn produced(&self) -> u64 {
        self.produced + self.segment.produced()
    }

    /// Samples that have arrived.
    pub fn received(&self) -> u64 {
        self.received + self.segment.received
    }

    /// Samples that have not arrived, wherever they were lost.
    pub fn dropped(&self) -> u64 {
        self.produced().saturating_sub(self.received())
    }

    /// Of those, the ones that the device had no room for, or has lost on its
    /// own link.
    pub fn dropped_by_device(&self) -> u64 {
        self.dropped + self.segment.dropped
    }

    /// Of those, the ones that were lost between the device and here.
    pub fn lost_on_line(&self) -> u64 {
        self.dropped().saturating_sub(self.dropped_by_device())
    }

    /// The tick after the last sample that has arrived; before any has, the
    /// first tick of the subscription.
    pub fn next_tick(&self) -> u64 {
        self.segment.next_tick
    }

    /// The first tick of the subscription, or since the drive has started
    /// anew.
    pub fn first_tick(&self) -> u64 {
        self.segment.first_tick
    }

    /// The last thousand gaps.
    pub fn gaps(&self) -> impl ExactSizeIterator<Item = &Gap> {
        self.gaps.iter()
    }

    /// How many gaps there were.
    pub fn gap_count(&self) -> u64 {
        self.gap_count
    }

    /// Times that the drive has started anew.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    /// Blocks that came twice, or too late.
    pub fn old_blocks(&self) -> u64 {
        self.old
    }

    /// Blocks after which the books did not balance: the device says that it
    /// has dropped more than is missing. A defect of its program.
    pub fn violations(&self) -> u64 {
        self.violations
    }
}

#[cfg(test)]
mod tests;

//! Sums of the samples that a client has received, and of those that it misses. How a gap is found, and who
//! counts it, is in [`crepitus_protocol::accounting`].
//!
//! When the drive restarts, a new *segment* begins; the sums continue.

use crepitus_protocol::accounting::{Begin, StreamPosition, Taken};
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

/// Sums since the subscription started, or the drive restarted.
#[derive(Clone, Copy, Debug)]
struct Segment {
    first_tick: u64,
    position: StreamPosition,
    received: u64,
    /// Dropped by the device; unlike the counter in a block this does not wrap.
    dropped: u64,
}

impl Segment {
    fn new(first_tick: u64, position: StreamPosition) -> Self {
        Self {
            first_tick,
            position,
            received: 0,
            dropped: 0,
        }
    }

    fn begin(begin: Begin) -> Self {
        Self::new(begin.first_tick, StreamPosition::at(begin))
    }

    fn produced(&self) -> u64 {
        self.position.next_tick().saturating_sub(self.first_tick)
    }
}

impl Accounting {
    /// Starts here.
    pub fn new(begin: Begin) -> Self {
        Self {
            produced: 0,
            received: 0,
            dropped: 0,
            segment: Segment::begin(begin),
            gaps: VecDeque::new(),
            gap_count: 0,
            restarts: 0,
            old: 0,
            violations: 0,
        }
    }

    /// Accounts for the next block.
    pub fn take(&mut self, block: &Block) -> Taken {
        let mut position = self.segment.position;
        let taken = position.take(block);
        let missing = match taken {
            Taken::Next(missing) => missing,
            Taken::Restarted(missing) => {
                self.restarts += 1;
                self.enter(Segment::new(missing.first_tick, position));
                missing
            }
            Taken::Old => {
                self.old += 1;
                return taken;
            }
        };
        let segment = &mut self.segment;
        segment.position = position;
        segment.received += SAMPLES;
        segment.dropped += missing.reported;
        // The device reports as dropped what has arrived here.
        if segment.received + segment.dropped > segment.produced() {
            self.violations += 1;
        }
        if missing.samples > 0 {
            self.gap_count += 1;
            if self.gaps.len() == GAPS {
                self.gaps.pop_front();
            }
            self.gaps.push_back(Gap {
                first_tick: missing.first_tick,
                samples: missing.samples,
            });
        }
        taken
    }

    /// Resumes here after a lost connection. Samples produced in
    /// between are not counted.
    pub(crate) fn resume(&mut self, begin: Begin) {
        self.enter(Segment::begin(begin));
    }

    fn enter(&mut self, segment: Segment) {
        self.produced += self.segment.produced();
        self.received += self.segment.received;
        self.dropped += self.segment.dropped;
        self.segment = segment;
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
        self.segment.position.next_tick()
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

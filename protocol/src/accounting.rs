//! Accounting of telemetry samples: which are missing, and which of them the device counts.
//!
//! ```text
//! drive ──> comms ──> connection ──> whoever subscribed
//!   produced   └ dropped by the device     └ received
//!                        └ lost on the connection
//!
//! produced = received + dropped by the device + lost on the connection
//! ```
//!
//! Each block carries the number of samples that the device has not sent so far, and the answer
//! to a subscription those before it; so all others that are missing were lost between the device
//! and here. Sums are exact up to the last block received.
//!
//! When the drive restarts, its ticks restart, too. Blocks lost after a restart and before the
//! first received one cannot be detected and are not counted.
//!
//! The client sums what [`StreamPosition::take`] returns, and a recording lists it by cause.

use crate::telemetry::Block;
use serde::{Deserialize, Serialize};

/// Start of a stream of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Begin {
    /// The first tick.
    pub first_tick: u64,
    /// Samples before it that the device has not sent.
    pub dropped: u32,
    /// The drive's start that counts them, as in the flags of its blocks.
    pub start: u8,
}

impl Begin {
    /// Start of the stream in which a block is the first after a restart of the drive: the device
    /// counts what it does not send from its start on, too.
    pub fn after_restart(block: &Block) -> Self {
        Self {
            first_tick: block.first_tick.saturating_sub(u64::from(block.dropped)),
            dropped: 0,
            start: block.flags.start(),
        }
    }
}

/// Consecutive samples that are missing before a block; none if `samples` is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Missing {
    /// Tick of the first one.
    pub first_tick: u64,
    /// Number of samples.
    pub samples: u64,
    /// Number of samples that the device says it has not sent. More than are missing is a fault
    /// of its firmware.
    pub reported: u64,
}

/// Relation of a block to the stream before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// A new block.
    Next(Missing),
    /// The first block after a restart of the drive.
    Restarted(Missing),
    /// A repeated block, or one older than the last.
    Old,
}

/// Place in a stream of blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamPosition {
    next_tick: u64,
    /// The device's own count at the last block; wraps.
    dropped: u32,
    start: u8,
}

impl StreamPosition {
    /// Returns the place before the first block.
    pub const fn at(begin: Begin) -> Self {
        Self {
            next_tick: begin.first_tick,
            dropped: begin.dropped,
            start: begin.start,
        }
    }

    /// The tick after the last sample; initially the first tick of the stream.
    pub const fn next_tick(&self) -> u64 {
        self.next_tick
    }

    /// The drive's start that produces the samples.
    pub const fn start(&self) -> u8 {
        self.start
    }

    /// Takes the next block.
    pub fn take(&mut self, block: &Block) -> Taken {
        let is_restart = block.flags.start() != self.start;
        if is_restart {
            *self = Self::at(Begin::after_restart(block));
        } else if block.first_tick < self.next_tick {
            return Taken::Old;
        }
        let missing = Missing {
            first_tick: self.next_tick,
            samples: block.first_tick.saturating_sub(self.next_tick),
            reported: u64::from(block.dropped.wrapping_sub(self.dropped)),
        };
        self.next_tick = block.end_tick();
        self.dropped = block.dropped;
        if is_restart {
            Taken::Restarted(missing)
        } else {
            Taken::Next(missing)
        }
    }

    /// Skips samples that are known to be missing, up to a tick; returns their number.
    pub fn skip_to(&mut self, tick: u64) -> u64 {
        let missing = tick.saturating_sub(self.next_tick);
        self.next_tick += missing;
        missing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;
    use crate::telemetry::BlockFlags;

    fn block(first_tick: u64, dropped: u32, start: u16) -> Block {
        Block {
            first_tick,
            dropped,
            flags: BlockFlags::new(State::Armed, false, start),
            ..Block::default()
        }
    }

    fn missing(first_tick: u64, samples: u64, reported: u64) -> Missing {
        Missing {
            first_tick,
            samples,
            reported,
        }
    }

    #[test]
    fn a_block_says_what_is_missing_before_it_and_what_of_it_the_device_counts() {
        let mut position = StreamPosition::at(Begin {
            first_tick: 1_000,
            dropped: 60,
            start: 1,
        });
        let next =
            |first_tick, samples, reported| Taken::Next(missing(first_tick, samples, reported));
        assert_eq!(position.take(&block(1_000, 60, 1)), next(1_000, 0, 0));
        assert_eq!(position.take(&block(1_080, 80, 1)), next(1_020, 60, 20));
        assert_eq!(position.take(&block(1_080, 80, 1)), Taken::Old);
        assert_eq!(position.take(&block(1_020, 80, 1)), Taken::Old);
        // More than are missing: the firmware's fault, which is not hidden.
        assert_eq!(position.take(&block(1_100, 100, 1)), next(1_100, 0, 20));
        let restarted = Taken::Restarted(missing(20, 40, 40));
        assert_eq!(
            position.take(&block(60, 60, 2)),
            Taken::Restarted(missing(0, 60, 60))
        );
        assert_eq!(position.take(&block(60, 40, 3)), restarted);
        assert_eq!((position.next_tick(), position.start()), (80, 3));
        assert_eq!([position.skip_to(100), position.skip_to(90)], [20, 0]);
        assert_eq!(position.next_tick(), 100);
    }

    #[test]
    fn the_count_of_the_device_may_wrap_and_ticks_may_be_any() {
        let mut position = StreamPosition::at(Begin {
            first_tick: 0,
            dropped: u32::MAX - 4,
            start: 1,
        });
        assert_eq!(
            position.take(&block(20, 15, 1)),
            Taken::Next(missing(0, 20, 20))
        );
        let last = block(u64::MAX, 15, 1);
        assert_eq!(
            position.take(&last),
            Taken::Next(missing(40, u64::MAX - 40, 0))
        );
        assert_eq!(position.next_tick(), u64::MAX);
    }
}

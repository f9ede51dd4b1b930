//! Samples to blocks, blocks to the link.
//!
//! Nothing waits for the link: a block that finds no place among those that
//! wait is dropped and its samples counted, and the blocks after it say how
//! many. Samples stay where they were written until the link has them.

use crate::counters::Counters;
use crepitus_protocol::Revision;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, BLOCK_TICKS, Block, BlockFlags, Sample};

/// Blocks that may wait for the link.
pub const QUEUE_BLOCKS: usize = 4;

/// Those, and the one that is being filled.
const PLACES: usize = QUEUE_BLOCKS + 1;

/// Fills blocks.
#[derive(Clone, Debug)]
pub struct Batch {
    blocks: [Block; PLACES],
    /// Which of them is being filled; those that wait are before it.
    filling: usize,
    filled: usize,
    waiting: usize,
    /// Of the block that is being filled.
    sequence: u16,
    first_tick: u64,
    dropped: u32,
}

impl Batch {
    /// An empty one whose first sample will be that of `first_tick`.
    pub fn new(first_tick: u64, sequence: u16) -> Self {
        Self {
            blocks: [Block::default(); PLACES],
            filling: 0,
            filled: 0,
            waiting: 0,
            sequence,
            first_tick,
            dropped: 0,
        }
    }

    /// Takes the sample of the next tick.
    pub fn push(
        &mut self,
        sample: Sample,
        revision: Revision,
        flags: BlockFlags,
        counters: &Counters,
    ) {
        let Some(block) = self.blocks.get_mut(self.filling) else {
            return;
        };
        if let Some(place) = block.samples.get_mut(self.filled) {
            *place = sample;
        }
        self.filled = self.filled.saturating_add(1);
        if self.filled < BLOCK_SAMPLES {
            return;
        }
        self.filled = 0;
        counters.add(DriveCounter::Produced, BLOCK_TICKS);
        if self.waiting < QUEUE_BLOCKS {
            (block.sequence, block.first_tick) = (self.sequence, self.first_tick);
            (block.revision, block.flags) = (revision, flags);
            block.dropped = self.dropped;
            self.waiting = self.waiting.saturating_add(1);
            self.filling = after(self.filling, 1);
        } else {
            counters.add(DriveCounter::Dropped, BLOCK_TICKS);
            self.dropped = self.dropped.wrapping_add(BLOCK_TICKS);
        }
        self.sequence = self.sequence.wrapping_add(1);
        self.first_tick = self.first_tick.wrapping_add(BLOCK_SAMPLES as u64);
    }

    /// Blocks that wait.
    pub fn waiting(&self) -> usize {
        self.waiting
    }

    /// The block that has waited longest. It stays until [`Self::pop`].
    pub fn front(&self) -> Option<&Block> {
        if self.waiting == 0 {
            return None;
        }
        let oldest = after(self.filling, PLACES.wrapping_sub(self.waiting));
        self.blocks.get(oldest)
    }

    /// The link has the block that has waited longest.
    pub fn pop(&mut self) {
        self.waiting = self.waiting.saturating_sub(1);
    }
}

/// The place that comes so many, at most [`PLACES`], after this one.
fn after(place: usize, more: usize) -> usize {
    let place = place.wrapping_add(more);
    if place < PLACES {
        place
    } else {
        place.wrapping_sub(PLACES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pop(batch: &mut Batch) -> Option<Block> {
        let block = batch.front().copied();
        batch.pop();
        block
    }

    #[test]
    fn what_finds_no_place_is_counted_and_said() {
        let counters = Counters::new();
        let mut batch = Batch::new(u64::MAX - 19, u16::MAX);
        let produce = |batch: &mut Batch, blocks: usize| {
            for _ in 0..blocks * BLOCK_SAMPLES {
                batch.push(
                    Sample::default(),
                    Revision(3),
                    BlockFlags::default(),
                    &counters,
                );
            }
        };
        produce(&mut batch, QUEUE_BLOCKS + 2);
        let mut received = 0;
        let mut last = None;
        while let Some(block) = pop(&mut batch) {
            received += 20;
            assert_eq!(block.dropped, 0);
            last = Some(block.sequence);
        }
        // Four found a place; the numbers go on through the wrap.
        assert_eq!((received, last), (80, Some(2)));
        produce(&mut batch, 1);
        let block = pop(&mut batch).unwrap();
        assert_eq!(
            (block.dropped, block.sequence, block.first_tick),
            (40, 5, 100)
        );
        received += 20;
        assert_eq!(counters.get(DriveCounter::Produced), received + 40);
        assert_eq!(counters.get(DriveCounter::Dropped), 40);
    }

    #[test]
    fn a_block_that_waits_is_not_written_over() {
        let counters = Counters::new();
        let mut batch = Batch::new(0, 0);
        let mut next = 0;
        let mut expected = 0;
        for waits in [0, 3, 1, 4, 4, 2, 0, 4] {
            for _ in 0..(waits + 1) * 20 {
                let sample = Sample {
                    count: next,
                    ..Sample::default()
                };
                batch.push(sample, Revision(1), BlockFlags::default(), &counters);
                next += 1;
            }
            while let Some(block) = pop(&mut batch) {
                let first = i32::try_from(block.first_tick).unwrap();
                assert!(first >= expected && block.first_tick.is_multiple_of(20));
                for (sample, n) in block.samples.iter().zip(first..) {
                    assert_eq!(sample.count, n);
                }
                expected = first + 20;
            }
        }
        assert_eq!(expected, next - 20, "one found no place at the end");
    }
}

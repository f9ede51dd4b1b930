//! Samples to blocks, blocks to the queue to the link.
//!
//! Nothing waits for the link: a block that finds no place in the queue is
//! dropped and its samples counted, and the blocks after it say how many.

use crate::counters::Counters;
use crepitus_protocol::Revision;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, BLOCK_TICKS, Block, BlockFlags, Sample};

/// Blocks that may wait for the link.
pub const QUEUE_BLOCKS: usize = 4;

/// Fills blocks.
#[derive(Clone, Debug)]
pub struct Batch {
    block: Block,
    filled: usize,
    queue: heapless::Deque<Block, QUEUE_BLOCKS>,
}

impl Batch {
    /// An empty one whose first sample will be that of `first_tick`.
    pub fn new(first_tick: u64, sequence: u16) -> Self {
        Self {
            block: Block {
                first_tick,
                sequence,
                ..Block::default()
            },
            filled: 0,
            queue: heapless::Deque::new(),
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
        if let Some(place) = self.block.samples.get_mut(self.filled) {
            *place = sample;
        }
        self.filled = self.filled.saturating_add(1);
        if self.filled < BLOCK_SAMPLES {
            return;
        }
        self.filled = 0;
        let samples = BLOCK_TICKS;
        counters.add(DriveCounter::Produced, samples);
        (self.block.revision, self.block.flags) = (revision, flags);
        if self.queue.push_back(self.block).is_err() {
            counters.add(DriveCounter::Dropped, samples);
            self.block.dropped = self.block.dropped.wrapping_add(samples);
        }
        self.block.sequence = self.block.sequence.wrapping_add(1);
        self.block.first_tick = self.block.first_tick.wrapping_add(BLOCK_SAMPLES as u64);
    }

    /// The next block for the link.
    pub fn pop(&mut self) -> Option<Block> {
        self.queue.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        while let Some(block) = batch.pop() {
            received += 20;
            assert_eq!(block.dropped, 0);
            last = Some(block.sequence);
        }
        // Four found a place; the numbers go on through the wrap.
        assert_eq!((received, last), (80, Some(2)));
        produce(&mut batch, 1);
        let block = batch.pop().unwrap();
        assert_eq!(
            (block.dropped, block.sequence, block.first_tick),
            (40, 5, 100)
        );
        received += 20;
        assert_eq!(counters.get(DriveCounter::Produced), received + 40);
        assert_eq!(counters.get(DriveCounter::Dropped), 40);
    }
}

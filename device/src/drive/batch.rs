//! Ring buffer of telemetry blocks for the link.
//!
//! Nothing blocks on the link: when the buffer is full a block is dropped and
//! its samples counted; the blocks after it carry the count. Samples are not
//! copied until the link sends them.

use crate::counters::Counters;
use crate::drive::emf_check;
use crate::drive::milliamperes::milliamperes;
use crepitus_protocol::Revision;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::telemetry::{
    BLOCK_SAMPLES, BLOCK_TICKS, Block, BlockFlags, COIL_CURRENTS, COIL_TICKS, CoilCurrent,
    EffectPhases, Sample,
};

/// Ticks of a window of the back-EMF check.
const WINDOW: usize = emf_check::TICKS as usize;

/// Blocks that may be queued for the link: while the frames of a commit arrive they take turns with the blocks.
pub const QUEUE_BLOCKS: usize = 8;

/// Slots of the ring buffer: the queue and the block that is being filled.
const SLOTS: usize = QUEUE_BLOCKS + 1;

/// Fills blocks and queues them.
#[derive(Clone, Debug)]
pub struct Batch {
    blocks: [Block; SLOTS],
    /// Slot that is being filled; the queued blocks are before it.
    filling: usize,
    filled: usize,
    queued: usize,
    /// Sequence number of the block that is being filled.
    sequence: u16,
    first_tick: u64,
    dropped: u32,
    /// Currents of the coil that were measured in the last ticks, A: sum and number.
    coil: (f32, u8),
}

impl Batch {
    /// An empty buffer whose first sample will be that of `first_tick`.
    pub fn new(first_tick: u64, sequence: u16) -> Self {
        Self {
            blocks: [Block::default(); SLOTS],
            filling: 0,
            filled: 0,
            queued: 0,
            sequence,
            first_tick,
            dropped: 0,
            coil: (0.0, 0),
        }
    }

    /// Adds a tick in which the coil was driven, before its sample. The mean of those that
    /// were measured is stored with the last of [`COIL_TICKS`], or where the coil goes to
    /// sleep.
    pub fn add_coil(&mut self, current_a: Option<f32>, goes_to_sleep: bool) {
        if let Some(current_a) = current_a {
            self.coil = (self.coil.0 + current_a, self.coil.1.saturating_add(1));
        }
        let ends = self.filled % COIL_TICKS == COIL_TICKS - 1;
        if !ends && !goes_to_sleep {
            return;
        }
        let (sum, count) = core::mem::take(&mut self.coil);
        let place = (self.blocks.get_mut(self.filling))
            .and_then(|block| block.coil_currents.get_mut(self.filled / COIL_TICKS));
        if let Some(place) = place.filter(|_| count > 0) {
            *place = CoilCurrent(milliamperes(sum / f32::from(count)));
        }
    }

    /// Adds the sample of the next tick, with the phases of the effects.
    pub fn push(
        &mut self,
        sample: Sample,
        phases: EffectPhases,
        revision: Revision,
        flags: BlockFlags,
        counters: &Counters,
    ) {
        let Some(block) = self.blocks.get_mut(self.filling) else {
            return;
        };
        if let (Some(sample_place), Some(phases_place)) = (
            block.samples.get_mut(self.filled),
            block.phases.get_mut(self.filled),
        ) {
            (*sample_place, *phases_place) = (sample, phases);
        }
        self.filled = self.filled.saturating_add(1);
        if self.filled < BLOCK_SAMPLES {
            return;
        }
        self.filled = 0;
        counters.add(DriveCounter::Produced, BLOCK_TICKS);
        if self.queued < QUEUE_BLOCKS {
            (block.sequence, block.first_tick) = (self.sequence, self.first_tick);
            (block.revision, block.flags) = (revision, flags);
            block.dropped = self.dropped;
            self.queued = self.queued.saturating_add(1);
            self.filling = after(self.filling, 1);
        } else {
            counters.add(DriveCounter::Dropped, BLOCK_TICKS);
            self.dropped = self.dropped.wrapping_add(BLOCK_TICKS);
        }
        if let Some(next) = self.blocks.get_mut(self.filling) {
            next.coil_currents = [CoilCurrent::NONE; COIL_CURRENTS];
        }
        self.sequence = self.sequence.wrapping_add(1);
        self.first_tick = self.first_tick.wrapping_add(BLOCK_SAMPLES as u64);
    }

    /// True if the next sample begins a block.
    pub fn begins_block(&self) -> bool {
        self.filled == 0
    }

    /// True if windows of the back-EMF check from the next sample on would end with blocks.
    pub fn ends_blocks_from_here(&self) -> bool {
        self.filled % WINDOW == WINDOW - 1
    }

    /// True if the next sample ends a block.
    pub fn ends_block(&self) -> bool {
        self.filled == BLOCK_SAMPLES - 1
    }

    /// Number of queued blocks.
    pub fn queued(&self) -> usize {
        self.queued
    }

    /// The oldest queued block. It stays until [`Self::pop`].
    pub fn front(&self) -> Option<&Block> {
        if self.queued == 0 {
            return None;
        }
        let oldest = after(self.filling, SLOTS.wrapping_sub(self.queued));
        self.blocks.get(oldest)
    }

    /// Removes the oldest queued block.
    pub fn pop(&mut self) {
        self.queued = self.queued.saturating_sub(1);
    }
}

/// The slot `more` (at most [`SLOTS`]) after this one.
fn after(slot: usize, more: usize) -> usize {
    let slot = slot.wrapping_add(more);
    if slot < SLOTS {
        slot
    } else {
        slot.wrapping_sub(SLOTS)
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

    fn push_one(batch: &mut Batch, counters: &Counters) {
        let (sample, phases) = (Sample::default(), EffectPhases::default());
        batch.push(sample, phases, Revision(3), BlockFlags::default(), counters);
    }

    #[test]
    fn windows_from_before_a_blocks_last_tick_end_with_blocks() {
        let counters = Counters::new();
        let mut batch = Batch::new(0, 0);
        for n in 0..3 * BLOCK_SAMPLES {
            assert_eq!(
                batch.ends_blocks_from_here(),
                n % WINDOW == WINDOW - 1,
                "{n}"
            );
            assert!(!batch.ends_block() || batch.ends_blocks_from_here());
            push_one(&mut batch, &counters);
        }
    }

    #[test]
    fn samples_dropped_for_want_of_space_are_counted() {
        let counters = Counters::new();
        let mut batch = Batch::new(u64::MAX - 19, u16::MAX);
        let produce = |batch: &mut Batch, blocks: usize| {
            for _ in 0..blocks * BLOCK_SAMPLES {
                push_one(batch, &counters);
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
        // Eight were queued; sequence numbers continue through the wrap.
        assert_eq!((received, last), (160, Some(6)));
        produce(&mut batch, 1);
        let block = pop(&mut batch).unwrap();
        assert_eq!(
            (block.dropped, block.sequence, block.first_tick),
            (40, 9, 180)
        );
        received += 20;
        assert_eq!(counters.get(DriveCounter::Produced), received + 40);
        assert_eq!(counters.get(DriveCounter::Dropped), 40);
    }

    #[test]
    fn a_block_has_the_means_of_what_was_measured_of_the_coil() {
        let counters = Counters::new();
        let mut batch = Batch::new(0, 0);
        // Two rounds of all slots; driven from the third tick of a block to its 12th.
        for n in 0..2 * SLOTS * BLOCK_SAMPLES {
            let place = u8::try_from(n % BLOCK_SAMPLES).unwrap();
            if (2..12).contains(&place) {
                let measured = (place != 7).then_some(f32::from(place) * 0.1 - 0.5);
                batch.add_coil(measured, place == 11);
            }
            let none = (Sample::default(), EffectPhases::default());
            let flags = BlockFlags::default();
            batch.push(none.0, none.1, Revision(1), flags, &counters);
            if let Some(block) = pop(&mut batch) {
                // Of 2, 3, 4; 5, 6, 8, 9; 10, 11.
                let expected = [-200, 200, 550, i16::MIN].map(CoilCurrent);
                assert_eq!(block.coil_currents, expected);
            }
        }
        // A block without any has none, in whichever slot.
        for _ in 0..SLOTS * BLOCK_SAMPLES {
            batch.push(
                Sample::default(),
                EffectPhases::default(),
                Revision(1),
                BlockFlags::default(),
                &counters,
            );
            if let Some(block) = pop(&mut batch) {
                assert_eq!(block.coil_currents, [CoilCurrent::NONE; COIL_CURRENTS]);
            }
        }
    }

    #[test]
    fn a_queued_block_is_not_overwritten() {
        let counters = Counters::new();
        let mut batch = Batch::new(0, 0);
        let mut next = 0;
        let mut expected = 0;
        for waits in [0, 7, 1, 8, 8, 2, 0, 8] {
            for _ in 0..(waits + 1) * 20 {
                let sample = Sample {
                    count: next,
                    ..Sample::default()
                };
                let phases = EffectPhases((next % 1_000).try_into().unwrap());
                batch.push(
                    sample,
                    phases,
                    Revision(1),
                    BlockFlags::default(),
                    &counters,
                );
                next += 1;
            }
            while let Some(block) = pop(&mut batch) {
                let first = i32::try_from(block.first_tick).unwrap();
                assert!(first >= expected && block.first_tick.is_multiple_of(20));
                for ((_, sample, phases), n) in block.ticks().zip(first..) {
                    assert_eq!((sample.count, i32::from(phases.0)), (n, n % 1_000));
                }
                expected = first + 20;
            }
        }
        assert_eq!(expected, next - 20, "one found no place at the end");
    }
}

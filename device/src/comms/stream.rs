//! The stream of blocks to the host, with the count of samples that were not
//! sent. There is one for all sessions; each knows where it has joined.

use crate::comms::outbox::Outbox;
use crepitus_protocol::Lane;
use crepitus_protocol::frame::{self, EncodedFrame, Encoder, FRAME_BYTES, FrameBuffer};
use crepitus_protocol::frame::{TooLong, WordCrc};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, BlockHead, EFFECT_PHASES_BYTES};

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

    /// Queues a block with the count of samples that were not sent, with most of the
    /// checksum by a unit; false if there is no room.
    pub fn forward(&mut self, unit: &mut impl WordCrc, block: &Block, outbox: &mut Outbox) -> bool {
        let mut buffer = [0; FRAME_BYTES];
        let dropped = self.dropped_before(block.first_tick);
        let frame = encode(unit, &mut buffer, block, dropped);
        let queued = frame.is_ok_and(|frame| outbox.telemetry(frame.bytes()));
        if queued {
            self.forwarded = self.forwarded.saturating_add(BLOCK_SAMPLES as u64);
        }
        queued
    }
}

/// Encodes a block with another count: its ticks in whole words, because field by field
/// they take several times as long.
fn encode<'a>(
    unit: &mut impl WordCrc,
    buffer: &'a mut FrameBuffer,
    block: &Block,
    dropped: u32,
) -> Result<EncodedFrame<&'a mut FrameBuffer>, TooLong> {
    let (sequence, first_tick, revision, _, end) = block.head();
    let head: BlockHead = (sequence, first_tick, revision, dropped, end);
    let mut encoder = Encoder::new(buffer, Lane::Telemetry)?;
    encoder.push(frame::write(&head, &mut [0; Block::HEAD_BYTES])?)?;
    for sample in &block.samples {
        encoder.push_by(unit, &sample.bytes())?;
    }
    let mut bytes = [0; BLOCK_SAMPLES * EFFECT_PHASES_BYTES];
    for (bytes, phases) in bytes.as_chunks_mut().0.iter_mut().zip(&block.phases) {
        *bytes = phases.bytes();
    }
    encoder.push_by(unit, &bytes)?;
    encoder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::frame::{DELIMITER, SoftwareCrc};
    use crepitus_protocol::telemetry::{CoilCurrent, EffectPhases, Sample};

    #[test]
    fn a_forwarded_block_differs_in_its_count_only() {
        let block = Block {
            first_tick: 340,
            samples: core::array::from_fn(|n| Sample {
                count: i32::MAX >> n,
                torque_nm: -1.0,
                ..Sample::default()
            }),
            phases: core::array::from_fn(|n| EffectPhases(u16::MAX >> (n % 16))),
            coil_currents: [1, -2, 300, -400].map(CoilCurrent),
            ..Block::default()
        };
        let mut outbox = Outbox::default();
        assert!(Stream::new(40).forward(&mut SoftwareCrc, &block, &mut outbox));
        let counted = Block {
            dropped: 300,
            ..block
        };
        let frame = frame::encode(Lane::Telemetry, &counted).unwrap();
        // The outbox begins with a delimiter.
        assert_eq!(outbox.to_send(), [&[DELIMITER], &frame[..]].concat());
    }
}

//! Frames of telemetry blocks without samples' content: all samples and phases are zero.
//!
//! The product's encoder looks at each byte. Under a fuzzer that costs more than
//! all else that a millisecond of comms does, and nothing new is found there
//! after the first block. These frames are the same, byte for byte, at a
//! twentieth of the cost.

use crepitus_protocol::frame::{self, CRC, CRC_BYTES, Frame};
use crepitus_protocol::telemetry::{Block, BlockFlags, COIL_BYTES, TICKS_BYTES};
use crepitus_protocol::{Lane, Revision};

/// Zero bytes of the samples and phases. The coil's currents are in the head.
const ZEROS: [u8; TICKS_BYTES - COIL_BYTES] = [0; TICKS_BYTES - COIL_BYTES];

/// First COBS code, lane, tag, the fields before the samples.
const HEAD_BYTES: usize = 3 + Block::HEAD_BYTES;

/// The frame of a block whose samples and phases are all zero.
pub(crate) fn encode(block: &Block) -> Frame {
    let mut bytes = [0; HEAD_BYTES];
    (bytes[1], bytes[2]) = (Lane::Telemetry.byte(), Lane::Telemetry.tag());
    let length = frame::write(&block.head(), &mut bytes[3..]).map(<[u8]>::len);
    let head = &mut bytes[..3 + length.expect("a head that fits")];
    let mut checksum = CRC.digest();
    checksum.update(&head[1..]);
    checksum.update(&ZEROS);
    let mut checksum = checksum.finalize().to_le_bytes();
    // COBS from the end: each zero becomes the distance to the next one, which
    // inside the samples is 1.
    let zeros_end = head.len() + ZEROS.len();
    let next = stuff(&mut checksum, zeros_end, zeros_end + CRC_BYTES);
    let first_zero = head.len();
    stuff(head, 0, first_zero);
    let mut frame = Frame::from_slice(head).expect("a head that fits");
    let filled = frame.resize(zeros_end - 1, 1);
    filled.expect("a block fits");
    frame
        .push(distance(zeros_end - 1, next))
        .expect("a block fits");
    frame.extend_from_slice(&checksum).expect("a block fits");
    frame.push(frame::DELIMITER).expect("a block fits");
    frame
}

/// Replaces zeros of `bytes`, which begin at `begin` of the frame; `next` is the
/// zero after them. Returns the first zero.
fn stuff(bytes: &mut [u8], begin: usize, mut next: usize) -> usize {
    for (at, byte) in bytes.iter_mut().enumerate().rev() {
        let at = begin + at;
        if *byte == 0 {
            *byte = distance(at, next);
            next = at;
        }
    }
    next
}

fn distance(at: usize, next: usize) -> u8 {
    u8::try_from(next - at).expect("runs are short")
}

/// Decodes a frame of the telemetry lane, if it is the one that [`encode`] makes.
pub(crate) fn decode(frame: &[u8]) -> Option<Block> {
    let (first, rest) = frame.split_first()?;
    let mut left = *first;
    let mut plain = rest.iter().map_while(|byte| {
        left = left.checked_sub(1)?;
        let byte = if left > 0 {
            *byte
        } else {
            left = *byte;
            0
        };
        Some(byte)
    });
    // Lane and tag.
    plain.nth(1)?;
    let mut varint = || {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = plain.next()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                break;
            }
        }
        Some(value)
    };
    let block = Block {
        sequence: varint()?.try_into().ok()?,
        first_tick: varint()?,
        revision: Revision(varint()?.try_into().ok()?),
        dropped: varint()?.try_into().ok()?,
        flags: BlockFlags(plain.next()?),
        ..Block::default()
    };
    (encode(&block) == frame).then_some(block)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_the_frames_of_the_product() {
        for (first_tick, dropped) in [(0, 0), (20, 60), (1 << 37, u32::MAX), (300, 128)] {
            for revision in [0, 1, 255, u32::MAX] {
                let block = Block {
                    sequence: u16::try_from(dropped % 700).unwrap(),
                    first_tick,
                    revision: Revision(revision),
                    dropped,
                    flags: BlockFlags(u8::try_from(revision % 256).unwrap()),
                    ..Block::default()
                };
                let frame = encode(&block);
                assert_eq!(frame, frame::encode(Lane::Telemetry, &block).unwrap());
                assert_eq!(decode(&frame), Some(block));
                for at in 0..frame.len() {
                    let mut other = frame.clone();
                    other[at] ^= 1;
                    assert_ne!(decode(&other), Some(block));
                }
            }
        }
    }
}

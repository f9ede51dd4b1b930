//! Messages to bytes.
//!
//! ```text
//! body   = lane ‖ tag ‖ postcard message
//! frame  = COBS(body ‖ CRC-32(body), little endian) ‖ 0x00
//! ```
//!
//! The CRC is that of zlib and Ethernet (CRC-32/ISO-HDLC). COBS leaves no zero
//! byte inside a frame, so a receiver that has lost its place finds it again
//! at the next zero byte.

use crate::lane::Lane;
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use serde::Serialize;

/// The longest body: lane, tag, message.
pub const BODY_BYTES: usize = 450;

/// Bytes of the checksum.
pub const CRC_BYTES: usize = 4;

/// The longest frame, with its end: COBS adds a byte for each 254 begun.
pub const FRAME_BYTES: usize = BODY_BYTES + CRC_BYTES + (BODY_BYTES + CRC_BYTES) / 254 + 2;

/// What ends a frame.
pub const DELIMITER: u8 = 0;

/// The checksum of both wires.
pub const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A frame, ready to be sent.
pub type Frame = heapless::Vec<u8, FRAME_BYTES>;

/// A message, with its lane and tag, does not fit a frame. No message of this
/// crate is that long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// A frame of a message.
///
/// # Errors
/// [`TooLong`] if the message is.
pub fn encode(lane: Lane, message: &impl Serialize) -> Result<Frame, TooLong> {
    let mut body = [0; BODY_BYTES];
    let (header, rest) = body.split_first_chunk_mut::<2>().ok_or(TooLong)?;
    *header = [lane.byte(), lane.tag()];
    let written = postcard::to_slice(message, rest)
        .map_err(|_| TooLong)?
        .len();
    encode_body(body.get(..2 + written).ok_or(TooLong)?)
}

/// A frame of bytes that are no postcard message: the management lane.
///
/// # Errors
/// [`TooLong`] if they are.
pub fn encode_bytes(lane: Lane, bytes: &[u8]) -> Result<Frame, TooLong> {
    let mut body = heapless::Vec::<u8, BODY_BYTES>::new();
    body.extend_from_slice(&[lane.byte(), lane.tag()])
        .and_then(|()| body.extend_from_slice(bytes))
        .map_err(|_| TooLong)?;
    encode_body(&body)
}

/// A frame of a body that has its lane and tag already.
///
/// # Errors
/// [`TooLong`] beyond [`BODY_BYTES`].
pub fn encode_body(body: &[u8]) -> Result<Frame, TooLong> {
    let mut plain = heapless::Vec::<u8, { BODY_BYTES + CRC_BYTES }>::new();
    plain.extend_from_slice(body).map_err(|_| TooLong)?;
    plain
        .extend_from_slice(&CRC.checksum(body).to_le_bytes())
        .map_err(|_| TooLong)?;
    let mut frame = Frame::new();
    frame.resize(FRAME_BYTES, DELIMITER).map_err(|_| TooLong)?;
    let length = cobs::try_encode(&plain, &mut frame).map_err(|_| TooLong)?;
    frame.truncate(length);
    frame.push(DELIMITER).map_err(|_| TooLong)?;
    Ok(frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_lane_tag_message_and_checksum() {
        let frame = encode(Lane::Management, &[b'H', 0]).unwrap();
        let mut plain = [0; 16];
        let length = cobs::decode(&frame[..frame.len() - 1], &mut plain)
            .unwrap()
            .frame_size();
        assert_eq!(&plain[..4], b"M1H\0");
        assert_eq!(&plain[4..length], CRC.checksum(b"M1H\0").to_le_bytes());
        assert_eq!(frame.last(), Some(&0));
        assert_eq!(frame.iter().position(|b| *b == 0), Some(frame.len() - 1));
    }

    #[test]
    fn every_length_up_to_the_longest_fits() {
        for length in 0..=BODY_BYTES {
            for byte in [0, 1, 255] {
                let body = std::vec![byte; length];
                assert!(encode_body(&body).is_ok(), "{length}");
            }
        }
        assert_eq!(encode_body(&[1; BODY_BYTES + 1]), Err(TooLong));
    }
}

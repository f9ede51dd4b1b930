//! Frame encoding.
//!
//! ```text
//! body   = lane ‖ tag ‖ postcard message
//! frame  = COBS(body ‖ CRC-32(body), little endian) ‖ 0x00
//! ```
//!
//! The CRC is that of zlib and Ethernet (CRC-32/ISO-HDLC). COBS leaves no zero
//! byte inside a frame, so a receiver resynchronises at the next zero byte.

use crate::checksum::Checksum;
use crate::lane::Lane;
use crate::schema::LONGEST_MESSAGE;
use cobs::{EncoderState, PushResult};
use core::borrow::BorrowMut;
use postcard::ser_flavors::Flavor;
use serde::Serialize;

pub use crate::checksum::{CRC, CRC_BYTES, SoftwareCrc, WORD, WordCrc};

/// The longest body: lane, tag, message.
pub const BODY_BYTES: usize = 2 + LONGEST_MESSAGE;

/// The longest frame, with its delimiter: COBS adds a byte for every 254 bytes
/// or part of them.
pub const FRAME_BYTES: usize = BODY_BYTES + CRC_BYTES + (BODY_BYTES + CRC_BYTES) / 254 + 2;

/// Delimiter after each frame.
pub const DELIMITER: u8 = 0;

/// An encoded frame.
pub type Frame = heapless::Vec<u8, FRAME_BYTES>;

/// A message, with its lane and tag, does not fit a frame. No message of this
/// crate is that long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// Buffer for the longest frame.
pub type FrameBuffer = [u8; FRAME_BYTES];

/// A frame in the buffer where it was encoded.
#[derive(Clone, Copy, Debug)]
pub struct EncodedFrame<P> {
    /// The buffer.
    pub buffer: P,
    /// Length of the frame, from the start of the buffer.
    pub length: usize,
}

/// Incremental encoder: computes checksum and COBS as the body arrives. `P` is a
/// [`FrameBuffer`], by value or by reference.
///
/// The COBS is that of the crate `cobs`, whose encoder says what to write where; the
/// buffer is here, so that a frame can be made in pieces and a DMA can send it.
#[derive(Debug)]
pub struct Encoder<P> {
    buffer: P,
    /// Length of what `cobs` is sure of.
    length: usize,
    cobs: EncoderState,
    /// Whether the place after a run of 254 bytes is a code: only if more follows.
    is_run_full: bool,
    checksum: Checksum,
}

impl<P: BorrowMut<FrameBuffer>> Encoder<P> {
    /// Starts a body without lane and tag.
    fn begin(buffer: P) -> Self {
        Self {
            buffer,
            // After the first code.
            length: 1,
            cobs: EncoderState::default(),
            is_run_full: false,
            checksum: Checksum::new(),
        }
    }

    /// Starts a frame of a lane in this buffer.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a buffer has room for lane and tag.
    pub fn new(buffer: P, lane: Lane) -> Result<Self, TooLong> {
        let mut encoder = Self::begin(buffer);
        encoder.push(&[lane.byte(), lane.tag()])?;
        Ok(encoder)
    }

    /// Appends bytes to the body.
    ///
    /// # Errors
    /// [`TooLong`] if there is no room for them.
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), TooLong> {
        self.push_by(&mut SoftwareCrc, bytes)
    }

    /// Appends bytes to the body, with the checksum of their whole words by a
    /// unit. Words go fastest.
    ///
    /// # Errors
    /// [`TooLong`] if there is no room for them.
    #[inline]
    pub fn push_by(&mut self, unit: &mut impl WordCrc, bytes: &[u8]) -> Result<(), TooLong> {
        self.checksum.update_by(unit, bytes);
        self.put(bytes)
    }

    /// Appends checksum and delimiter.
    ///
    /// # Errors
    /// [`TooLong`] if there is no room for them.
    pub fn finish(mut self) -> Result<EncodedFrame<P>, TooLong> {
        let checksum = self.checksum.value();
        self.put(&checksum.to_le_bytes())?;
        let buffer = self.buffer.borrow_mut();
        if !self.is_run_full {
            let (code_at, code) = self.cobs.finalize();
            set(buffer, code_at, code)?;
        }
        set(buffer, self.length, DELIMITER)?;
        Ok(EncodedFrame {
            buffer: self.buffer,
            length: self.length.wrapping_add(1),
        })
    }

    // In one place, so that a serialiser that pushes every field does not have it once a field. With
    // copies of the state, which the compiler keeps in registers.
    #[inline(never)]
    fn put(&mut self, bytes: &[u8]) -> Result<(), TooLong> {
        let buffer = self.buffer.borrow_mut();
        let (mut cobs, mut length) = (self.cobs.clone(), self.length);
        let mut is_run_full = self.is_run_full;
        for byte in bytes {
            length = length.wrapping_add(usize::from(is_run_full));
            is_run_full = false;
            match cobs.push(*byte) {
                PushResult::AddSingle(byte) => set(buffer, length, byte)?,
                PushResult::ModifyFromStartAndSkip((code_at, code)) => set(buffer, code_at, code)?,
                PushResult::ModifyFromStartAndPushAndSkip((code_at, code, byte)) => {
                    set(buffer, code_at, code)?;
                    set(buffer, length, byte)?;
                    is_run_full = true;
                }
            }
            length = length.wrapping_add(1);
        }
        (self.cobs, self.length, self.is_run_full) = (cobs, length, is_run_full);
        Ok(())
    }
}

#[inline]
fn set(buffer: &mut [u8], at: usize, byte: u8) -> Result<(), TooLong> {
    *buffer.get_mut(at).ok_or(TooLong)? = byte;
    Ok(())
}

impl<P: BorrowMut<FrameBuffer>> EncodedFrame<P> {
    /// The frame's bytes.
    pub fn bytes(&self) -> &[u8] {
        self.buffer.borrow().get(..self.length).unwrap_or_default()
    }

    /// Copies the frame.
    pub fn frame(&self) -> Frame {
        // Cannot fail: a buffer is as long as the longest frame.
        Frame::from_slice(self.bytes()).unwrap_or_default()
    }
}

/// Serialises a postcard message into a frame.
struct Message<'a, 'b>(&'a mut Encoder<&'b mut FrameBuffer>);

impl Flavor for Message<'_, '_> {
    type Output = ();

    fn try_extend(&mut self, data: &[u8]) -> postcard::Result<()> {
        self.0
            .push(data)
            .map_err(|_| postcard::Error::SerializeBufferFull)
    }

    fn try_push(&mut self, data: u8) -> postcard::Result<()> {
        self.try_extend(&[data])
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
    }
}

/// Serialises a postcard message into a slice, byte by byte: most of its pieces
/// are so short that a call of `memcpy`, as postcard's own makes it, takes three
/// times as long.
struct Bytes<'a> {
    buffer: &'a mut [u8],
    length: usize,
}

impl Flavor for Bytes<'_> {
    type Output = usize;

    #[inline]
    fn try_push(&mut self, data: u8) -> postcard::Result<()> {
        let place = self.buffer.get_mut(self.length);
        *place.ok_or(postcard::Error::SerializeBufferFull)? = data;
        self.length = self.length.wrapping_add(1);
        Ok(())
    }

    // In one place, so that the firmware's gate has one loop to bound.
    #[inline(never)]
    fn try_extend(&mut self, data: &[u8]) -> postcard::Result<()> {
        data.iter().try_for_each(|byte| self.try_push(*byte))
    }

    fn finalize(self) -> postcard::Result<usize> {
        Ok(self.length)
    }
}

/// Bytes of a word at most, 7 bits in each.
const WORD_DIGITS: usize = 5;

/// Serialises words into `buffer` as postcard does, in a fraction of its time.
///
/// # Errors
/// [`TooLong`] if there is no room for them.
pub fn write_words<'a>(words: &[u32], buffer: &'a mut [u8]) -> Result<&'a [u8], TooLong> {
    const MORE: u32 = 0x80;
    let mut length = 0_usize;
    for word in words {
        let mut rest = *word;
        for _ in 0..WORD_DIGITS {
            let [digit, ..] = (if rest < MORE { rest } else { rest | MORE }).to_le_bytes();
            set(buffer, length, digit)?;
            length = length.wrapping_add(1);
            rest >>= 7;
            if rest == 0 {
                break;
            }
        }
    }
    buffer.get(..length).ok_or(TooLong)
}

/// Serialises a message into `buffer`, without a frame.
///
/// # Errors
/// [`TooLong`] if there is no room for them.
pub fn write<'a>(message: &impl Serialize, buffer: &'a mut [u8]) -> Result<&'a [u8], TooLong> {
    let bytes = Bytes { buffer, length: 0 };
    let length = postcard::serialize_with_flavor(message, bytes).map_err(|_| TooLong)?;
    buffer.get(..length).ok_or(TooLong)
}

/// Encodes a message as a frame, in a buffer.
///
/// # Errors
/// [`TooLong`] if the message does not fit.
pub fn encode_in<'a>(
    buffer: &'a mut FrameBuffer,
    lane: Lane,
    message: &impl Serialize,
) -> Result<&'a [u8], TooLong> {
    let mut encoder = Encoder::new(&mut *buffer, lane)?;
    postcard::serialize_with_flavor(message, Message(&mut encoder)).map_err(|_| TooLong)?;
    let length = encoder.finish()?.length;
    buffer.get(..length).ok_or(TooLong)
}

/// Encodes a message as a frame.
///
/// # Errors
/// [`TooLong`] if the message does not fit.
pub fn encode(lane: Lane, message: &impl Serialize) -> Result<Frame, TooLong> {
    let mut buffer = [0; FRAME_BYTES];
    let frame = encode_in(&mut buffer, lane, message)?;
    Frame::from_slice(frame).map_err(|_| TooLong)
}

/// Encodes bytes that are no postcard message as a frame: the management lane.
///
/// # Errors
/// [`TooLong`] if they do not fit.
pub fn encode_bytes(lane: Lane, bytes: &[u8]) -> Result<Frame, TooLong> {
    let mut encoder = Encoder::new([0; FRAME_BYTES], lane)?;
    encoder.push(bytes)?;
    Ok(encoder.finish()?.frame())
}

/// Encodes a body that includes lane and tag.
///
/// # Errors
/// [`TooLong`] beyond [`BODY_BYTES`].
pub fn encode_body(body: &[u8]) -> Result<Frame, TooLong> {
    let mut encoder = Encoder::begin([0; FRAME_BYTES]);
    encoder.push(body)?;
    Ok(encoder.finish()?.frame())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;
    use proptest::prelude::*;
    use std::vec::Vec;

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

    /// The frame that another implementation makes of a body.
    fn expected(body: &[u8]) -> Vec<u8> {
        let mut plain = body.to_vec();
        plain.extend(CRC.checksum(body).to_le_bytes());
        let mut frame = reference::encode(&plain);
        frame.push(DELIMITER);
        frame
    }

    #[test]
    fn any_bytes_of_words_may_be_zero() {
        for zeros in 0..1_u32 << 12 {
            let body: [u8; 12] =
                core::array::from_fn(|n| if zeros >> n & 1 == 1 { 0 } else { 0x80 });
            assert_eq!(&*encode_body(&body).unwrap(), expected(&body));
        }
    }

    proptest! {
        /// However a body is split, its frame equals that of another implementation for
        /// the whole body, also for runs of about 254 bytes.
        #[test]
        fn pieces_make_the_frame_of_the_whole(
            mut body in prop::collection::vec(any::<u8>(), 2..=BODY_BYTES),
            only_zero in prop::option::of(250_usize..260),
            piece in 1_usize..100,
        ) {
            if let Some(zero) = only_zero {
                for byte in &mut body {
                    *byte |= 1;
                }
                if let Some(byte) = body.get_mut(zero) {
                    *byte = 0;
                }
            }
            let expected = expected(&body);
            let mut encoder = Encoder::begin([0; FRAME_BYTES]);
            for piece in body.chunks(piece) {
                encoder.push(piece).unwrap();
            }
            let made = encoder.finish().unwrap();
            prop_assert_eq!(made.bytes(), expected);
        }
    }
}

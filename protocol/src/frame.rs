//! Frame encoding.
//!
//! ```text
//! body   = lane ‖ tag ‖ postcard message
//! frame  = COBS(body ‖ CRC-32(body), little endian) ‖ 0x00
//! ```
//!
//! The CRC is that of zlib and Ethernet (CRC-32/ISO-HDLC). COBS leaves no zero
//! byte inside a frame, so a receiver resynchronises at the next zero byte.

use crate::lane::Lane;
use crate::schema::LONGEST_MESSAGE;
use core::borrow::BorrowMut;
use core::fmt::{self, Debug, Formatter};
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use postcard::ser_flavors::Flavor;
use serde::Serialize;

/// The longest body: lane, tag, message.
pub const BODY_BYTES: usize = 2 + LONGEST_MESSAGE;

/// Bytes of the checksum.
pub const CRC_BYTES: usize = 4;

/// The longest frame, with its delimiter: COBS adds a byte for every 254 bytes
/// or part of them.
pub const FRAME_BYTES: usize = BODY_BYTES + CRC_BYTES + (BODY_BYTES + CRC_BYTES) / 254 + 2;

/// Delimiter after each frame.
pub const DELIMITER: u8 = 0;

/// The checksum of both wires.
pub static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// An encoded frame.
pub type Frame = heapless::Vec<u8, FRAME_BYTES>;

/// A message, with its lane and tag, does not fit a frame. No message of this
/// crate is that long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// Incremental checksum: the register of the CRC, lowest bit first.
#[derive(Clone, Copy)]
pub(crate) struct Checksum(u32);

impl Checksum {
    pub(crate) fn new() -> Self {
        Self(u32::MAX)
    }

    #[inline]
    pub(crate) fn update(&mut self, bytes: &[u8]) {
        // `Crc` takes the register highest bit first, and returns it inverted.
        let mut digest = CRC.digest_with_initial(self.0.reverse_bits());
        digest.update(bytes);
        self.0 = !digest.finalize();
    }

    /// [`Self::update`] with whole words by a unit.
    #[inline]
    pub(crate) fn update_by(&mut self, unit: &mut impl WordCrc, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks();
        if !words.is_empty() {
            self.0 = unit.update(self.0, words);
        }
        if !rest.is_empty() {
            self.update(rest);
        }
    }

    pub(crate) fn value(self) -> u32 {
        !self.0
    }
}

impl Debug for Checksum {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "Checksum({:#010x})", self.value())
    }
}

/// Computes the checksum of whole words; a microcontroller has a unit for it.
pub trait WordCrc {
    /// Returns the register of the CRC, lowest bit first, after these words.
    fn update(&mut self, register: u32, words: &[[u8; WORD]]) -> u32;
}

/// Implementation in software.
#[derive(Clone, Copy, Debug, Default)]
pub struct SoftwareCrc;

impl WordCrc for SoftwareCrc {
    fn update(&mut self, register: u32, words: &[[u8; WORD]]) -> u32 {
        let mut checksum = Checksum(register);
        checksum.update(words.as_flattened());
        checksum.0
    }
}

/// Bytes of a word.
pub const WORD: usize = 4;

/// The largest code of COBS: 254 bytes without a zero.
const FULL: usize = 255;

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
/// COBS is implemented here and in the decoder because the crate `cobs` takes
/// three times as long, 6 % of the drive's time, and has panic paths that the
/// compiler cannot exclude. The tests use it as their reference.
#[derive(Debug)]
pub struct Encoder<P> {
    buffer: P,
    length: usize,
    /// Position of the COBS code of the current run.
    code_at: usize,
    checksum: Checksum,
}

impl<P: BorrowMut<FrameBuffer>> Encoder<P> {
    /// Starts a body without lane and tag.
    fn begin(buffer: P) -> Self {
        Self {
            buffer,
            // After the first code.
            length: 1,
            code_at: 0,
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
        let (words, rest) = bytes.as_chunks();
        self.put_words(words)?;
        self.put(rest)
    }

    /// Appends checksum and delimiter.
    ///
    /// # Errors
    /// [`TooLong`] if there is no room for them.
    pub fn finish(mut self) -> Result<EncodedFrame<P>, TooLong> {
        let checksum = self.checksum.value();
        self.put_words(&[checksum.to_le_bytes()])?;
        let buffer = self.buffer.borrow_mut();
        set(buffer, self.code_at, code(self.code_at, self.length))?;
        set(buffer, self.length, DELIMITER)?;
        Ok(EncodedFrame {
            buffer: self.buffer,
            length: self.length.wrapping_add(1),
        })
    }

    /// Fast path: while no run can get full, each word keeps its position and a
    /// zero becomes the next code. A word takes the same time however many zeros it has,
    /// as phases of effects at rest are nothing else.
    fn put_words(&mut self, words: &[[u8; WORD]]) -> Result<(), TooLong> {
        let (mut at, mut code_at) = (self.length, self.code_at);
        let bytes = words.as_flattened();
        if at.saturating_add(bytes.len()).wrapping_sub(code_at) > FULL {
            return self.put(bytes);
        }
        let buffer = self.buffer.borrow_mut();
        for word in words {
            let end = at.wrapping_add(WORD);
            let mut coded = u32::from_le_bytes(*word);
            let zeros = zero_bytes(*word);
            if zeros != 0 {
                coded |= inner_codes(zeros);
                let first = at.wrapping_add((zeros.trailing_zeros() / u8::BITS) as usize);
                set(buffer, code_at, code(code_at, first))?;
                code_at = end.wrapping_sub((zeros.leading_zeros() / u8::BITS) as usize + 1);
            }
            let place = buffer.get_mut(at..).and_then(<[u8]>::first_chunk_mut);
            *place.ok_or(TooLong)? = coded.to_le_bytes();
            at = end;
        }
        (self.length, self.code_at) = (at, code_at);
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), TooLong> {
        bytes.iter().try_for_each(|byte| self.put_one(*byte))
    }

    fn put_one(&mut self, byte: u8) -> Result<(), TooLong> {
        let buffer = self.buffer.borrow_mut();
        if self.length.wrapping_sub(self.code_at) == FULL {
            set(buffer, self.code_at, u8::MAX)?;
            self.code_at = self.length;
            self.length = self.length.wrapping_add(1);
        }
        set(buffer, self.length, byte)?;
        if byte == 0 {
            set(buffer, self.code_at, code(self.code_at, self.length))?;
            self.code_at = self.length;
        }
        self.length = self.length.wrapping_add(1);
        Ok(())
    }
}

/// The highest bit of each byte of a word that is zero.
fn zero_bytes(word: [u8; WORD]) -> u32 {
    const LOW: u32 = 0x7f7f_7f7f;
    let word = u32::from_le_bytes(word);
    // No carry reaches the next byte.
    !((word & LOW).wrapping_add(LOW) | word | LOW)
}

/// The codes of those of these zeros that another one of the same word follows, one,
/// two or three bytes on.
fn inner_codes(zeros: u32) -> u32 {
    let zero = zeros >> 7;
    let (one_on, two_on, three_on) = (zero >> 8, zero >> 16, zero >> 24);
    let further = zero & !one_on;
    let (two, three) = (further & two_on, further & !two_on & three_on);
    zero & one_on | two << 1 | three << 1 | three
}

/// The COBS code at `at` of a run that ends before `end`, at most 255 on.
fn code(at: usize, end: usize) -> u8 {
    let [code, ..] = end.wrapping_sub(at).to_le_bytes();
    code
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
    use proptest::prelude::*;

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

    /// The frame that `cobs` makes of a body.
    fn reference(body: &[u8]) -> std::vec::Vec<u8> {
        let mut plain = body.to_vec();
        plain.extend(CRC.checksum(body).to_le_bytes());
        let mut frame = std::vec![0; FRAME_BYTES];
        let length = cobs::try_encode(&plain, &mut frame).unwrap();
        frame.truncate(length);
        frame.push(DELIMITER);
        frame
    }

    #[test]
    fn any_bytes_of_words_may_be_zero() {
        for zeros in 0..1_u32 << 12 {
            let body: [u8; 12] =
                core::array::from_fn(|n| if zeros >> n & 1 == 1 { 0 } else { 0x80 });
            assert_eq!(&*encode_body(&body).unwrap(), reference(&body));
        }
    }

    proptest! {
        /// However a body is split, its frame equals that of `cobs` for the
        /// whole body, also for runs of about 254 bytes.
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
            let expected = reference(&body);
            let mut encoder = Encoder::begin([0; FRAME_BYTES]);
            for piece in body.chunks(piece) {
                encoder.push(piece).unwrap();
            }
            let made = encoder.finish().unwrap();
            prop_assert_eq!(made.bytes(), expected);
        }
    }
}

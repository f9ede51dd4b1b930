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
use cobs::{EncoderState, PushResult};
use core::borrow::BorrowMut;
use core::fmt::{self, Debug, Formatter};
use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};
use postcard::ser_flavors::Flavor;
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
pub static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A frame, ready to be sent.
pub type Frame = heapless::Vec<u8, FRAME_BYTES>;

/// A message, with its lane and tag, does not fit a frame. No message of this
/// crate is that long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// A checksum on its way.
#[derive(Clone)]
pub(crate) struct Checksum(Digest<'static, u32, Table<1>>);

impl Checksum {
    pub(crate) fn new() -> Self {
        Self(CRC.digest())
    }

    #[inline]
    pub(crate) fn update(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    pub(crate) fn value(&self) -> u32 {
        self.0.clone().finalize()
    }
}

impl Debug for Checksum {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "Checksum({:#010x})", self.value())
    }
}

/// Makes a frame as its body comes, piece by piece: checksum and COBS are done
/// with the last byte. `F` is the frame's place, by value or by reference.
#[derive(Debug)]
pub struct Encoder<F> {
    frame: F,
    cobs: EncoderState,
    /// A run of 254 bytes is complete: if more follows, its code comes first.
    is_full_run: bool,
    checksum: Checksum,
}

impl<F: BorrowMut<Frame>> Encoder<F> {
    /// Begins a body without lane and tag.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a frame has room for a byte.
    fn begin(mut frame: F) -> Result<Self, TooLong> {
        let place = frame.borrow_mut();
        place.clear();
        // The first code, once it is known.
        place.push(DELIMITER).map_err(|_| TooLong)?;
        Ok(Self {
            frame,
            cobs: EncoderState::default(),
            is_full_run: false,
            checksum: Checksum::new(),
        })
    }

    /// Begins a frame of a lane, in this place.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a frame has room for lane and tag.
    pub fn new(frame: F, lane: Lane) -> Result<Self, TooLong> {
        let mut encoder = Self::begin(frame)?;
        encoder.push(&[lane.byte(), lane.tag()])?;
        Ok(encoder)
    }

    /// Goes on with these bytes of the body.
    ///
    /// # Errors
    /// [`TooLong`] if there is no room for them.
    #[inline]
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), TooLong> {
        self.checksum.update(bytes);
        self.put(bytes)
    }

    /// Checksum and end.
    ///
    /// # Errors
    /// [`TooLong`] if there is no room for them.
    pub fn finish(mut self) -> Result<F, TooLong> {
        let checksum = self.checksum.value();
        self.put(&checksum.to_le_bytes())?;
        let (at, code) = self.cobs.finalize();
        let place = self.frame.borrow_mut();
        if !self.is_full_run {
            set(place, at, code)?;
        }
        place.push(DELIMITER).map_err(|_| TooLong)?;
        Ok(self.frame)
    }

    #[inline]
    fn put(&mut self, bytes: &[u8]) -> Result<(), TooLong> {
        let place = self.frame.borrow_mut();
        let add = |place: &mut Frame, byte| place.push(byte).map_err(|_| TooLong);
        for byte in bytes {
            if self.is_full_run {
                self.is_full_run = false;
                add(place, DELIMITER)?;
            }
            match self.cobs.push(*byte) {
                PushResult::AddSingle(byte) => add(place, byte)?,
                PushResult::ModifyFromStartAndSkip((at, code)) => {
                    set(place, at, code)?;
                    add(place, DELIMITER)?;
                }
                PushResult::ModifyFromStartAndPushAndSkip((at, code, byte)) => {
                    set(place, at, code)?;
                    add(place, byte)?;
                    self.is_full_run = true;
                }
            }
        }
        Ok(())
    }
}

fn set(frame: &mut Frame, at: usize, code: u8) -> Result<(), TooLong> {
    *frame.get_mut(at).ok_or(TooLong)? = code;
    Ok(())
}

/// A postcard message on its way into a frame.
struct Message<'a>(&'a mut Encoder<Frame>);

impl Flavor for Message<'_> {
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

/// A frame of a message.
///
/// # Errors
/// [`TooLong`] if the message is.
pub fn encode(lane: Lane, message: &impl Serialize) -> Result<Frame, TooLong> {
    let mut encoder = Encoder::new(Frame::new(), lane)?;
    postcard::serialize_with_flavor(message, Message(&mut encoder)).map_err(|_| TooLong)?;
    encoder.finish()
}

/// A frame of bytes that are no postcard message: the management lane.
///
/// # Errors
/// [`TooLong`] if they are.
pub fn encode_bytes(lane: Lane, bytes: &[u8]) -> Result<Frame, TooLong> {
    let mut encoder = Encoder::new(Frame::new(), lane)?;
    encoder.push(bytes)?;
    encoder.finish()
}

/// A frame of a body that has its lane and tag already.
///
/// # Errors
/// [`TooLong`] beyond [`BODY_BYTES`].
pub fn encode_body(body: &[u8]) -> Result<Frame, TooLong> {
    let mut encoder = Encoder::begin(Frame::new())?;
    encoder.push(body)?;
    encoder.finish()
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

    proptest! {
        /// In whatever pieces a body comes, its frame is what `cobs` makes of
        /// the whole of it; runs of 254 bytes without a zero among them.
        #[test]
        fn pieces_make_the_frame_of_the_whole(
            mut body in prop::collection::vec(any::<u8>(), 2..=BODY_BYTES),
            zeros in 0_u8..3,
            piece in 1_usize..100,
        ) {
            if zeros == 0 {
                body.iter_mut().for_each(|byte| *byte |= 1);
            }
            let mut plain = body.clone();
            plain.extend(CRC.checksum(&body).to_le_bytes());
            let mut expected = std::vec![0; FRAME_BYTES];
            let length = cobs::try_encode(&plain, &mut expected).unwrap();
            expected.truncate(length);
            expected.push(DELIMITER);
            let mut encoder = Encoder::begin(Frame::new()).unwrap();
            for piece in body.chunks(piece) {
                encoder.push(piece).unwrap();
            }
            prop_assert_eq!(&encoder.finish().unwrap()[..], expected);
        }
    }
}

//! Frame decoding, as the bytes arrive: one by one, or as many at once as there are.
//!
//! The first complete frame after a delimiter is always received: the decoder
//! discards and counts invalid bytes and resynchronises at the next zero byte.

use crate::checksum::{CRC_BYTES, Checksum, SoftwareCrc, WORD, WordCrc};
use crate::frame::{BODY_BYTES, DELIMITER, FRAME_BYTES};
use crate::lane::Lane;
use cobs::{DecodeResult, DecoderState};
use crc::CRC_32_ISO_HDLC;
use serde::Deserialize;

/// Reasons for which the bytes between two delimiters are discarded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FrameError {
    /// More bytes than any frame has.
    Overlong,
    /// Invalid COBS, or too short for lane, tag and checksum.
    Malformed,
    /// Wrong checksum.
    Checksum,
}

/// Body of a frame with a valid checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body<'a> {
    /// The lane's byte.
    pub lane: u8,
    /// The tag.
    pub tag: u8,
    /// The message's bytes.
    pub payload: &'a [u8],
}

impl<'a> Body<'a> {
    /// The lane, if it is known and the tag matches.
    pub fn lane(&self) -> Option<Lane> {
        Lane::of(self.lane).filter(|lane| lane.tag() == self.tag)
    }

    /// The message, if the payload is valid, without extra bytes.
    pub fn message<T: Deserialize<'a>>(&self) -> Option<T> {
        match postcard::take_from_bytes(self.payload) {
            Ok((message, [])) => Some(message),
            _ => None,
        }
    }
}

/// Counters of discarded frames; they wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Discarded {
    /// Frames that were too long.
    pub overlong: u32,
    /// Malformed frames.
    pub malformed: u32,
    /// Frames with a wrong checksum.
    pub checksum: u32,
}

impl Discarded {
    /// Sum of the counters.
    pub fn total(&self) -> u32 {
        self.overlong
            .wrapping_add(self.malformed)
            .wrapping_add(self.checksum)
    }
}

/// Incremental decoder: computes COBS, by the crate `cobs`, and checksum as bytes arrive,
/// so the last byte costs hardly more than the others.
#[derive(Debug)]
pub struct Decoder {
    cobs: DecoderState,
    /// Body and checksum received so far.
    plain: [u8; BODY_BYTES + CRC_BYTES],
    /// Bytes of it.
    filled: usize,
    checksum: Checksum,
    /// Bytes included in the checksum.
    summed: usize,
    /// Bytes since the last delimiter.
    length: usize,
    discarded: Discarded,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

/// Bytes added to the checksum at a time.
const CHUNK: usize = 8;

/// Checksum of a body with its own checksum appended.
const RESIDUE: u32 = CRC_32_ISO_HDLC.residue ^ CRC_32_ISO_HDLC.xorout;

impl Decoder {
    /// Starts at the beginning of a frame.
    pub fn new() -> Self {
        Self {
            cobs: DecoderState::Idle,
            plain: [0; BODY_BYTES + CRC_BYTES],
            filled: 0,
            checksum: Checksum::new(),
            summed: 0,
            length: 0,
            discarded: Discarded::default(),
        }
    }

    /// Decodes the next byte; at a delimiter returns the frame or the error.
    /// Empty frames are ignored.
    pub fn push(&mut self, byte: u8) -> Option<Result<Body<'_>, FrameError>> {
        self.push_by(&mut SoftwareCrc, byte)
    }

    /// Decodes the next byte, as [`push`](Self::push), with most of the checksum by a unit.
    pub fn push_by(
        &mut self,
        unit: &mut impl WordCrc,
        byte: u8,
    ) -> Option<Result<Body<'_>, FrameError>> {
        self.extend_by(unit, &[byte]).1
    }

    /// Decodes bytes up to the first delimiter among them: how many, and the
    /// frame or the error that ends there.
    pub fn extend(&mut self, bytes: &[u8]) -> (usize, Option<Result<Body<'_>, FrameError>>) {
        self.extend_by(&mut SoftwareCrc, bytes)
    }

    /// Decodes bytes, as [`extend`](Self::extend), with most of the checksum by a unit.
    pub fn extend_by(
        &mut self,
        unit: &mut impl WordCrc,
        bytes: &[u8],
    ) -> (usize, Option<Result<Body<'_>, FrameError>>) {
        let end = bytes.iter().position(|byte| *byte == DELIMITER);
        self.add_part(
            unit,
            bytes.get(..end.unwrap_or(bytes.len())).unwrap_or(bytes),
        );
        match end {
            Some(end) => (end.saturating_add(1), self.end(unit)),
            None => (bytes.len(), None),
        }
    }

    /// Decodes bytes without a delimiter among them.
    pub fn add_part(&mut self, unit: &mut impl WordCrc, bytes: &[u8]) {
        if bytes.is_empty() {
            return;
        }
        self.begin();
        self.length = self.length.saturating_add(bytes.len());
        // A copy, which the compiler keeps in registers.
        let (mut cobs, mut filled) = (core::mem::take(&mut self.cobs), self.filled);
        for byte in bytes {
            // A byte that is no delimiter is valid wherever it stands.
            let Ok(DecodeResult::DataContinue(plain)) = cobs.feed(*byte) else {
                continue;
            };
            match self.plain.get_mut(filled) {
                Some(place) => {
                    *place = plain;
                    filled = filled.wrapping_add(1);
                }
                // No body is so long.
                None => self.length = FRAME_BYTES,
            }
        }
        (self.cobs, self.filled) = (cobs, filled);
        if self.filled.wrapping_sub(self.summed) >= CHUNK {
            self.sum_words(unit);
        }
    }

    /// Resets the decoder before the first byte of a frame.
    #[inline]
    fn begin(&mut self) {
        if self.length == 0 {
            self.reset();
        }
    }

    /// A delimiter: the frame or the error, unless there were no bytes.
    pub fn end(&mut self, unit: &mut impl WordCrc) -> Option<Result<Body<'_>, FrameError>> {
        let length = core::mem::take(&mut self.length);
        if length == 0 {
            return None;
        }
        self.sum_up(unit);
        let count = &mut self.discarded;
        // `FRAME_BYTES` includes the delimiter.
        if length >= FRAME_BYTES {
            count.overlong = count.overlong.wrapping_add(1);
            return Some(Err(FrameError::Overlong));
        }
        let ended = self.cobs.feed(DELIMITER);
        let plain = self.plain.get(..self.filled);
        let plain = plain.and_then(<[u8]>::split_last_chunk::<CRC_BYTES>);
        let opened = if let (Ok(DecodeResult::DataComplete), Some(([lane, tag, payload @ ..], _))) =
            (ended, plain)
        {
            if self.checksum.value() == RESIDUE {
                Ok(Body {
                    lane: *lane,
                    tag: *tag,
                    payload,
                })
            } else {
                count.checksum = count.checksum.wrapping_add(1);
                Err(FrameError::Checksum)
            }
        } else {
            count.malformed = count.malformed.wrapping_add(1);
            Err(FrameError::Malformed)
        };
        Some(opened)
    }

    /// Discards a partial frame, after a disconnect.
    pub fn reset(&mut self) {
        self.cobs = DecoderState::Idle;
        self.filled = 0;
        self.checksum = Checksum::new();
        self.summed = 0;
        self.length = 0;
    }

    /// Adds the whole words that were received to the checksum.
    #[inline]
    fn sum_words(&mut self, unit: &mut impl WordCrc) {
        let new = self.plain.get(self.summed..self.filled).unwrap_or_default();
        let whole = new.len() & !(WORD - 1);
        self.checksum
            .update_by(unit, new.get(..whole).unwrap_or_default());
        self.summed = self.summed.saturating_add(whole);
    }

    /// Adds the received bytes to the checksum, up to the end.
    #[inline]
    fn sum_up(&mut self, unit: &mut impl WordCrc) {
        let new = self.plain.get(self.summed..self.filled).unwrap_or_default();
        self.checksum.update_by(unit, new);
        self.summed = self.filled;
    }

    /// Counters of discarded frames.
    pub fn discarded(&self) -> Discarded {
        self.discarded
    }
}

#[cfg(test)]
mod tests;

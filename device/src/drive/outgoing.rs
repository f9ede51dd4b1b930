//! Incremental frame encoder for comms: one piece in every run of the link
//! task, so that no tick encodes a whole frame.

use core::borrow::BorrowMut;
use crepitus_protocol::Lane;
use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::crash::{PART_WORDS, Part};
use crepitus_protocol::frame::{self, EncodedFrame, Encoder, FrameBuffer, TooLong, WordCrc};
use crepitus_protocol::link::{COUNTER_BYTES, DriveStatus};
use crepitus_protocol::management::{Answer, AnswerBytes};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, BlockHead, SAMPLE_BYTES, Sample};

/// Samples per piece: with its head a block takes eleven of its twenty ticks.
pub const PIECE_SAMPLES: usize = 2;
const _: () = assert!(BLOCK_SAMPLES.is_multiple_of(PIECE_SAMPLES));

/// Bytes per piece of a management reply.
const ANSWER_BYTES: usize = 32;

/// Bytes of the longest other piece.
const PIECE_BYTES: usize = DriveStatus::HEAD_BYTES;
const _: () = assert!(Block::HEAD_BYTES <= PIECE_BYTES);
const _: () = assert!(PIECE_WORDS * COUNTER_BYTES <= PIECE_BYTES);

/// Words per piece of a status's counters, or of the post-mortem record.
const PIECE_WORDS: usize = 4;

/// The part of a frame that is still to be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rest {
    /// A management reply, from this byte on.
    Answer(usize),
    /// Both parts of the head of a status.
    Status,
    /// The second part of it.
    StatusEnd,
    /// The counters of a status, from this one on.
    Counters(usize),
    /// The words of a part of the post-mortem record, from this one on.
    CrashPart(usize),
    /// The samples of a block, from this one on.
    Samples(usize),
}

/// Encodes one frame at a time, in buffers `P`.
#[derive(Debug)]
pub struct Outgoing<P> {
    current: Option<(Encoder<P>, Rest)>,
    answer: AnswerBytes,
    status: DriveStatus,
    crash_part: [u32; PART_WORDS],
    /// The bytes of a piece before they are framed. Kept, because clearing it for each
    /// takes as long as filling it.
    bytes: [u8; PIECE_BYTES],
}

impl<P> Default for Outgoing<P> {
    fn default() -> Self {
        Self {
            current: None,
            answer: AnswerBytes::new(),
            status: DriveStatus::default(),
            crash_part: [0; PART_WORDS],
            bytes: [0; PIECE_BYTES],
        }
    }
}

impl<P: BorrowMut<FrameBuffer>> Outgoing<P> {
    /// Whether no frame is in progress.
    pub fn is_idle(&self) -> bool {
        self.current.is_none()
    }

    /// Starts the frame of a management reply.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a reply fits.
    pub fn begin_answer(&mut self, buffer: P, answer: &Answer) -> Result<(), TooLong> {
        self.answer = answer.bytes();
        let encoder = Encoder::new(buffer, Lane::ManagementAnswer)?;
        self.current = Some((encoder, Rest::Answer(0)));
        Ok(())
    }

    /// Starts the frame of a status.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a status fits.
    pub fn begin_status(&mut self, buffer: P, status: &DriveStatus) -> Result<(), TooLong> {
        self.status = *status;
        let encoder = Encoder::new(buffer, Lane::FromDrive)?;
        self.current = Some((encoder, Rest::Status));
        Ok(())
    }

    /// Starts the frame of a part of the post-mortem record.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a part fits.
    pub fn begin_crash_part(&mut self, buffer: P, part: &Part) -> Result<(), TooLong> {
        let mut encoder = Encoder::new(buffer, Lane::FromDrive)?;
        encoder.push(frame::write(&part.head(), &mut self.bytes)?)?;
        let left = if let Some(words) = part.words {
            self.crash_part = words;
            0
        } else {
            PART_WORDS
        };
        self.current = Some((encoder, Rest::CrashPart(left)));
        Ok(())
    }

    /// Starts the frame of a block; its samples follow in pieces.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a block fits.
    pub fn begin_block(&mut self, buffer: P, head: &BlockHead) -> Result<(), TooLong> {
        let mut encoder = Encoder::new(buffer, Lane::Telemetry)?;
        encoder.push(frame::write(head, &mut self.bytes)?)?;
        self.current = Some((encoder, Rest::Samples(0)));
        Ok(())
    }

    /// Index of the first sample of the next piece, if a block is in progress.
    pub fn next_sample(&self) -> Option<usize> {
        match self.current {
            Some((_, Rest::Samples(next))) => Some(next),
            _ => None,
        }
    }

    /// Encodes samples of the block; returns the finished frame after the last.
    pub fn samples(
        &mut self,
        unit: &mut impl WordCrc,
        piece: &[Sample; PIECE_SAMPLES],
    ) -> Option<EncodedFrame<P>> {
        let (encoder, Rest::Samples(next)) = self.current.as_mut()? else {
            return None;
        };
        let mut bytes = [0; PIECE_SAMPLES * SAMPLE_BYTES];
        for (bytes, sample) in bytes.as_chunks_mut().0.iter_mut().zip(piece) {
            *bytes = sample.bytes();
        }
        encoder.push_by(unit, &bytes).ok()?;
        *next = next.saturating_add(PIECE_SAMPLES);
        if *next < BLOCK_SAMPLES {
            return None;
        }
        self.finish()
    }

    /// Encodes the next piece of a reply or a status; returns the finished frame
    /// after the last.
    pub fn piece(&mut self, unit: &mut impl WordCrc) -> Option<EncodedFrame<P>> {
        let (encoder, rest) = self.current.as_mut()?;
        let is_whole = match rest {
            Rest::Answer(next) => {
                let left = self.answer.get(*next..)?;
                let piece = left.get(..ANSWER_BYTES).unwrap_or(left);
                encoder.push_by(unit, piece).ok()?;
                *next = next.saturating_add(ANSWER_BYTES);
                *next >= self.answer.len()
            }
            Rest::Status => {
                let begin = frame::write(&self.status.head().0, &mut self.bytes).ok()?;
                encoder.push_by(unit, begin).ok()?;
                *rest = Rest::StatusEnd;
                false
            }
            Rest::StatusEnd => {
                let end = frame::write(&self.status.head().1, &mut self.bytes).ok()?;
                encoder.push_by(unit, end).ok()?;
                *rest = Rest::Counters(0);
                false
            }
            Rest::Counters(next) => {
                let left = self.status.counters.get(*next..)?;
                push_words(encoder, unit, &mut self.bytes, left)?;
                *next = next.saturating_add(PIECE_WORDS);
                *next >= DRIVE_COUNT
            }
            Rest::CrashPart(next) => {
                let left = self.crash_part.get(*next..)?;
                push_words(encoder, unit, &mut self.bytes, left)?;
                *next = next.saturating_add(PIECE_WORDS);
                *next >= PART_WORDS
            }
            Rest::Samples(_) => false,
        };
        if is_whole { self.finish() } else { None }
    }

    fn finish(&mut self) -> Option<EncodedFrame<P>> {
        let (encoder, _) = self.current.take()?;
        encoder.finish().ok()
    }
}

/// Encodes the first of these words.
fn push_words<P: BorrowMut<FrameBuffer>>(
    encoder: &mut Encoder<P>,
    unit: &mut impl WordCrc,
    bytes: &mut [u8; PIECE_BYTES],
    words: &[u32],
) -> Option<()> {
    let mut length = 0_usize;
    for word in words.iter().take(PIECE_WORDS) {
        let written = frame::write(word, bytes.get_mut(length..)?).ok()?;
        length = length.saturating_add(written.len());
    }
    encoder.push_by(unit, bytes.get(..length)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::frame::{FRAME_BYTES, Frame, SoftwareCrc};
    use crepitus_protocol::link::FromDrive;
    use crepitus_protocol::management::Identity;

    type Places = Outgoing<FrameBuffer>;

    /// Runs the encoder to the end of a frame; returns it and the number of runs.
    fn run(outgoing: &mut Places, block: &Block) -> (Frame, usize) {
        for runs in 1..100 {
            let made = match outgoing.next_sample() {
                Some(next) => {
                    let piece = block.samples[next..].first_chunk().unwrap();
                    outgoing.samples(&mut SoftwareCrc, piece)
                }
                None => outgoing.piece(&mut SoftwareCrc),
            };
            if let Some(made) = made {
                assert!(outgoing.is_idle());
                return (made.frame(), runs);
            }
        }
        panic!("no end");
    }

    #[test]
    fn pieces_make_the_frames_that_a_whole_message_makes() {
        let mut outgoing = Places::default();
        let buffer = || [0; FRAME_BYTES];
        let status = DriveStatus {
            tick: 1 << 40,
            counters: core::array::from_fn(|n| u32::MAX >> n),
            ..DriveStatus::default()
        };
        let mut block = Block {
            first_tick: 300,
            ..Block::default()
        };
        for (sample, n) in block.samples.iter_mut().zip(1_u8..) {
            (sample.count, sample.torque_nm) = (n.into(), f32::from(n));
        }
        let answer = Answer::Hello {
            token: 7,
            own: Identity::default(),
            drive: Identity::default(),
        };
        outgoing.begin_status(buffer(), &status).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        let whole = FromDrive::Status(status);
        assert_eq!(frame, frame::encode(Lane::FromDrive, &whole).unwrap());
        assert!(runs <= 7, "{runs}");
        for words in [None, Some(core::array::from_fn(|n| u32::MAX >> (2 * n)))] {
            let part = Part { number: 3, words };
            outgoing.begin_crash_part(buffer(), &part).unwrap();
            let (frame, runs) = run(&mut outgoing, &block);
            let whole = FromDrive::CrashPart(part);
            assert_eq!(frame, frame::encode(Lane::FromDrive, &whole).unwrap());
            assert!(runs <= 4, "{runs}");
        }
        outgoing.begin_block(buffer(), &block.head()).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        assert_eq!(frame, frame::encode(Lane::Telemetry, &block).unwrap());
        assert_eq!(runs, BLOCK_SAMPLES / PIECE_SAMPLES);
        outgoing.begin_answer(buffer(), &answer).unwrap();
        let (frame, _) = run(&mut outgoing, &block);
        let whole = frame::encode_bytes(Lane::ManagementAnswer, &answer.bytes());
        assert_eq!(frame, whole.unwrap());
    }
}

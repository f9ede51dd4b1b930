//! Incremental frame encoder for comms: one piece in every run of the link
//! task, so that no tick encodes a whole frame.

use core::borrow::BorrowMut;
use crepitus_protocol::Lane;
use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::crash::{PART_WORDS, Part};
use crepitus_protocol::frame::{self, EncodedFrame, Encoder, FrameBuffer, TooLong, WordCrc};
use crepitus_protocol::link::{COUNTER_BYTES, DriveStatus, FromDrive};
use crepitus_protocol::management::{Answer, AnswerBytes};
use crepitus_protocol::task_times::TIMES_WORDS;
use crepitus_protocol::telemetry::{
    BLOCK_SAMPLES, Block, BlockHead, EFFECT_PHASES_BYTES, EffectPhases, SAMPLE_BYTES, Sample,
};

/// Samples per piece: with its head, which takes two, and its phases a block takes fourteen of
/// its twenty ticks.
pub const PIECE_SAMPLES: usize = 2;
const _: () = assert!(BLOCK_SAMPLES.is_multiple_of(PIECE_SAMPLES));

/// Phases of the first and of the last piece: as many words as samples have, and few, as the
/// last piece also ends the frame.
pub const FIRST_PHASES: usize = 16;
/// See [`FIRST_PHASES`].
pub const LAST_PHASES: usize = BLOCK_SAMPLES - FIRST_PHASES;

/// Bytes per piece of a management reply.
const ANSWER_BYTES: usize = 32;

/// Bytes of the longest other piece.
const PIECE_BYTES: usize = DriveStatus::HEAD_BYTES;
const _: () = assert!(Block::HEAD_BYTES <= PIECE_BYTES);
const _: () = assert!(PIECE_WORDS * COUNTER_BYTES <= PIECE_BYTES);

/// Words per piece of a status's counters, of the post-mortem record, or of the tasks' times.
const PIECE_WORDS: usize = 4;

/// The part of a frame that is still to be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rest {
    /// A management reply, from this byte on.
    Answer(usize),
    /// The head of a status, from this part on.
    Status(u8),
    /// The counters of a status, from this one on.
    Counters(usize),
    /// The words of a part of the post-mortem record, from this one on.
    CrashPart(usize),
    /// The words of the tasks' times, from this one on.
    Times(usize),
    /// Checksum and delimiter; those of a block come with its last phases.
    End,
    /// The head of a block, so many bytes, which were written when it began.
    Head(usize),
    /// The samples of a block, from this one on, and then its phases. These three are last,
    /// as [`Outgoing::piece`] does not meet them: a table of jumps without a hole.
    Samples(usize),
    FirstPhases,
    LastPhases,
}

/// The next piece of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockPiece {
    /// Samples, from this one on: [`Outgoing::samples`].
    Samples(usize),
    /// The first phases: [`Outgoing::first_phases`].
    FirstPhases,
    /// The last phases: [`Outgoing::last_phases`].
    LastPhases,
}

/// The first phases of a block.
pub fn first_phases(block: &Block) -> Option<&[EffectPhases; FIRST_PHASES]> {
    block.phases.first_chunk()
}

/// The last phases of a block.
pub fn last_phases(block: &Block) -> Option<&[EffectPhases; LAST_PHASES]> {
    block.phases.last_chunk()
}

/// Encodes one frame at a time, in buffers `P`.
#[derive(Debug)]
pub struct Outgoing<P> {
    current: Option<Encoder<P>>,
    /// Part of the current frame that is still to be encoded.
    rest: Rest,
    answer: AnswerBytes,
    status: DriveStatus,
    crash_part: [u32; PART_WORDS],
    times: [u32; TIMES_WORDS],
    /// The bytes of a piece before they are framed. Kept, because clearing it for each
    /// takes as long as filling it.
    bytes: [u8; PIECE_BYTES],
}

impl<P> Default for Outgoing<P> {
    fn default() -> Self {
        Self {
            current: None,
            rest: Rest::End,
            answer: AnswerBytes::new(),
            status: DriveStatus::default(),
            crash_part: [0; PART_WORDS],
            times: [0; TIMES_WORDS],
            bytes: [0; PIECE_BYTES],
        }
    }
}

impl<P: BorrowMut<FrameBuffer>> Outgoing<P> {
    /// Returns whether no frame is in progress.
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
        (self.current, self.rest) = (Some(encoder), Rest::Answer(0));
        Ok(())
    }

    /// The next status. While one is being sent nobody changes it.
    pub fn status_mut(&mut self) -> &mut DriveStatus {
        &mut self.status
    }

    /// Starts the frame of [the status](Self::status_mut).
    ///
    /// # Errors
    /// [`TooLong`]; never, as a status fits.
    pub fn begin_status(&mut self, buffer: P) -> Result<(), TooLong> {
        let encoder = Encoder::new(buffer, Lane::FromDrive)?;
        (self.current, self.rest) = (Some(encoder), Rest::Status(0));
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
        (self.current, self.rest) = (Some(encoder), Rest::CrashPart(left));
        Ok(())
    }

    /// Words of the next times. While they are being sent nobody changes them.
    pub fn times_mut(&mut self) -> &mut [u32; TIMES_WORDS] {
        &mut self.times
    }

    /// Starts the frame of [the times](Self::times_mut).
    ///
    /// # Errors
    /// [`TooLong`]; never, as they fit.
    pub fn begin_times(&mut self, buffer: P) -> Result<(), TooLong> {
        let mut encoder = Encoder::new(buffer, Lane::FromDrive)?;
        encoder.push(&[FromDrive::TIMES])?;
        (self.current, self.rest) = (Some(encoder), Rest::Times(0));
        Ok(())
    }

    /// Starts the frame of a block; its head, samples and phases follow in pieces.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a block fits.
    pub fn begin_block(&mut self, buffer: P, head: &BlockHead) -> Result<(), TooLong> {
        let encoder = Encoder::new(buffer, Lane::Telemetry)?;
        let length = frame::write(head, &mut self.bytes)?.len();
        (self.current, self.rest) = (Some(encoder), Rest::Head(length));
        Ok(())
    }

    /// The next piece of the block, if one is in progress.
    pub fn block_piece(&self) -> Option<BlockPiece> {
        match (&self.current, self.rest) {
            (Some(_), Rest::Samples(next)) => Some(BlockPiece::Samples(next)),
            (Some(_), Rest::FirstPhases) => Some(BlockPiece::FirstPhases),
            (Some(_), Rest::LastPhases) => Some(BlockPiece::LastPhases),
            _ => None,
        }
    }

    /// Encodes samples of the block.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a block fits.
    pub fn samples(
        &mut self,
        unit: &mut impl WordCrc,
        piece: &[Sample; PIECE_SAMPLES],
    ) -> Result<(), TooLong> {
        let (Some(encoder), Rest::Samples(next)) = (&mut self.current, self.rest) else {
            return Ok(());
        };
        let mut bytes = [0; PIECE_SAMPLES * SAMPLE_BYTES];
        for (bytes, sample) in bytes.as_chunks_mut().0.iter_mut().zip(piece) {
            *bytes = sample.bytes();
        }
        encoder.push_by(unit, &bytes)?;
        let next = next.saturating_add(PIECE_SAMPLES);
        self.rest = if next < BLOCK_SAMPLES {
            Rest::Samples(next)
        } else {
            Rest::FirstPhases
        };
        Ok(())
    }

    /// Encodes the first phases of the block.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a block fits.
    pub fn first_phases(
        &mut self,
        unit: &mut impl WordCrc,
        piece: &[EffectPhases; FIRST_PHASES],
    ) -> Result<(), TooLong> {
        let (Some(encoder), Rest::FirstPhases) = (&mut self.current, self.rest) else {
            return Ok(());
        };
        let mut bytes = [0; FIRST_PHASES * EFFECT_PHASES_BYTES];
        for (bytes, phases) in bytes.as_chunks_mut().0.iter_mut().zip(piece) {
            *bytes = phases.bytes();
        }
        encoder.push_by(unit, &bytes)?;
        self.rest = Rest::LastPhases;
        Ok(())
    }

    /// Encodes the last phases of the block; returns the finished frame.
    pub fn last_phases(
        &mut self,
        unit: &mut impl WordCrc,
        piece: &[EffectPhases; LAST_PHASES],
    ) -> Option<EncodedFrame<P>> {
        let (Some(encoder), Rest::LastPhases) = (&mut self.current, self.rest) else {
            return None;
        };
        let mut bytes = [0; LAST_PHASES * EFFECT_PHASES_BYTES];
        for (bytes, phases) in bytes.as_chunks_mut().0.iter_mut().zip(piece) {
            *bytes = phases.bytes();
        }
        encoder.push_by(unit, &bytes).ok()?;
        self.finish()
    }

    /// Encodes the next piece of a reply or a status, or the head of a block; returns the finished frame
    /// after the last.
    pub fn piece(&mut self, unit: &mut impl WordCrc) -> Option<EncodedFrame<P>> {
        let encoder = self.current.as_mut()?;
        let (written, next) = match self.rest {
            Rest::Answer(from) => {
                let left = self.answer.get(from..)?;
                let piece = left.get(..ANSWER_BYTES).unwrap_or(left);
                let to = from.saturating_add(ANSWER_BYTES);
                let is_whole = to >= self.answer.len();
                (
                    piece,
                    if is_whole {
                        Rest::End
                    } else {
                        Rest::Answer(to)
                    },
                )
            }
            Rest::Status(part) => {
                let (begin, middle, end) = self.status.head();
                let (written, next) = match part {
                    0 => (frame::write(&begin, &mut self.bytes), Rest::Status(1)),
                    1 => (frame::write(&middle, &mut self.bytes), Rest::Status(2)),
                    _ => (frame::write(&end, &mut self.bytes), Rest::Counters(0)),
                };
                (written.ok()?, next)
            }
            Rest::Counters(from) => {
                let to = from.saturating_add(PIECE_WORDS);
                let is_whole = to >= DRIVE_COUNT;
                let words = self.status.counters.get(from..)?;
                let next = if is_whole {
                    Rest::End
                } else {
                    Rest::Counters(to)
                };
                (write_words(words, &mut self.bytes)?, next)
            }
            Rest::CrashPart(from) => {
                let to = from.saturating_add(PIECE_WORDS);
                let is_whole = to >= PART_WORDS;
                let words = self.crash_part.get(from..)?;
                let next = if is_whole {
                    Rest::End
                } else {
                    Rest::CrashPart(to)
                };
                (write_words(words, &mut self.bytes)?, next)
            }
            Rest::Times(from) => {
                let to = from.saturating_add(PIECE_WORDS);
                let is_whole = to >= TIMES_WORDS;
                let words = self.times.get(from..)?;
                let next = if is_whole { Rest::End } else { Rest::Times(to) };
                (write_words(words, &mut self.bytes)?, next)
            }
            Rest::Head(length) => (self.bytes.get(..length)?, Rest::Samples(0)),
            Rest::Samples(_) | Rest::FirstPhases | Rest::LastPhases => return None,
            Rest::End => return self.finish(),
        };
        encoder.push_by(unit, written).ok()?;
        self.rest = next;
        None
    }

    fn finish(&mut self) -> Option<EncodedFrame<P>> {
        self.current.take()?.finish().ok()
    }
}

/// Serialises the first of these words.
fn write_words<'a>(words: &[u32], bytes: &'a mut [u8; PIECE_BYTES]) -> Option<&'a [u8]> {
    let piece = words.get(..PIECE_WORDS).unwrap_or(words);
    frame::write_words(piece, bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::Revision;
    use crepitus_protocol::frame::{FRAME_BYTES, Frame, SoftwareCrc};
    use crepitus_protocol::management::Identity;
    use crepitus_protocol::task_times::TaskTimes;
    use crepitus_protocol::telemetry::{BlockFlags, CoilCurrent};

    type Places = Outgoing<FrameBuffer>;

    /// Runs the encoder to the end of a frame; returns it and the number of runs.
    fn run(outgoing: &mut Places, block: &Block) -> (Frame, usize) {
        for runs in 1..100 {
            let made = match outgoing.block_piece() {
                Some(BlockPiece::Samples(next)) => {
                    let piece = block.samples[next..].first_chunk().unwrap();
                    outgoing.samples(&mut SoftwareCrc, piece).unwrap();
                    None
                }
                Some(BlockPiece::FirstPhases) => {
                    let piece = first_phases(block).unwrap();
                    outgoing.first_phases(&mut SoftwareCrc, piece).unwrap();
                    None
                }
                Some(BlockPiece::LastPhases) => {
                    let piece = last_phases(block).unwrap();
                    outgoing.last_phases(&mut SoftwareCrc, piece)
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
            sequence: 700,
            first_tick: 1 << 40,
            revision: Revision(300),
            dropped: 20,
            flags: BlockFlags(7),
            phases: core::array::from_fn(|n| EffectPhases(u16::MAX >> (n % 15))),
            coil_currents: [-3, 0, 700, i16::MIN].map(CoilCurrent),
            ..Block::default()
        };
        for (sample, n) in block.samples.iter_mut().zip(1_u8..) {
            (sample.count, sample.torque_nm) = (-i32::from(n), f32::from(n));
        }
        let answer = Answer::Hello {
            token: 7,
            own: Identity::default(),
            drive: Identity::default(),
        };
        *outgoing.status_mut() = status;
        outgoing.begin_status(buffer()).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        let whole = FromDrive::Status(status);
        assert_eq!(frame, frame::encode(Lane::FromDrive, &whole).unwrap());
        assert!(runs <= 9, "{runs}");
        for words in [None, Some(core::array::from_fn(|n| u32::MAX >> (2 * n)))] {
            let part = Part { number: 3, words };
            outgoing.begin_crash_part(buffer(), &part).unwrap();
            let (frame, runs) = run(&mut outgoing, &block);
            let whole = FromDrive::CrashPart(part);
            assert_eq!(frame, frame::encode(Lane::FromDrive, &whole).unwrap());
            assert!(runs <= 5, "{runs}");
        }
        let times = TaskTimes {
            latest_sample: u32::MAX,
            stack_bytes: 65_536,
            ..TaskTimes::default()
        };
        *outgoing.times_mut() = times.words();
        outgoing.begin_times(buffer()).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        let whole = FromDrive::Times(times);
        assert_eq!(frame, frame::encode(Lane::FromDrive, &whole).unwrap());
        assert!(runs <= 6, "{runs}");
        outgoing.begin_block(buffer(), &block.head()).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        assert_eq!(frame, frame::encode(Lane::Telemetry, &block).unwrap());
        // Head, samples, phases.
        assert_eq!(runs, 1 + BLOCK_SAMPLES / PIECE_SAMPLES + 2);
        outgoing.begin_answer(buffer(), &answer).unwrap();
        let (frame, _) = run(&mut outgoing, &block);
        let whole = frame::encode_bytes(Lane::ManagementAnswer, &answer.bytes());
        assert_eq!(frame, whole.unwrap());
    }
}

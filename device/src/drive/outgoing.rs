//! The frame that is being made for comms, a piece in every run of the link's
//! task: no tick pays for a whole one.

use core::borrow::BorrowMut;
use crepitus_protocol::Lane;
use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::frame::{self, Encoder, Made, Place, TooLong};
use crepitus_protocol::link::{COUNTER_BYTES, DriveStatus};
use crepitus_protocol::management::{Answer, AnswerBytes};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, SAMPLE_BYTES, Sample};

/// Samples of a piece: with its head a block takes eleven of its twenty ticks.
pub const PIECE_SAMPLES: usize = 2;
const _: () = assert!(BLOCK_SAMPLES.is_multiple_of(PIECE_SAMPLES));

/// Bytes of a piece of an answer.
const PIECE_BYTES: usize = 32;

/// Counters of a piece of a status.
const PIECE_COUNTERS: usize = 5;

/// What is to come of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rest {
    /// An answer, from here on.
    Answer(usize),
    /// A status, the head of which has so many bytes.
    Status(usize),
    /// Its counters, from here on.
    Counters(usize),
    /// The samples of a block, from here on.
    Samples(usize),
}

/// Makes frames, one after the other, in places `P`.
#[derive(Debug)]
pub struct Outgoing<P> {
    making: Option<(Encoder<P>, Rest)>,
    answer: AnswerBytes,
    head: [u8; DriveStatus::HEAD_BYTES],
    counters: [u32; DRIVE_COUNT],
}

impl<P> Default for Outgoing<P> {
    fn default() -> Self {
        Self {
            making: None,
            answer: AnswerBytes::new(),
            head: [0; DriveStatus::HEAD_BYTES],
            counters: [0; DRIVE_COUNT],
        }
    }
}

impl<P: BorrowMut<Place>> Outgoing<P> {
    /// Whether no frame is being made.
    pub fn is_idle(&self) -> bool {
        self.making.is_none()
    }

    /// Begins the frame of an answer.
    ///
    /// # Errors
    /// [`TooLong`]; never, as an answer fits.
    pub fn begin_answer(&mut self, place: P, answer: &Answer) -> Result<(), TooLong> {
        self.answer = answer.bytes();
        let encoder = Encoder::new(place, Lane::ManagementAnswer)?;
        self.making = Some((encoder, Rest::Answer(0)));
        Ok(())
    }

    /// Begins the frame of a status.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a status fits.
    pub fn begin_status(&mut self, place: P, status: &DriveStatus) -> Result<(), TooLong> {
        let length = frame::write(&status.head(), &mut self.head)?.len();
        self.counters = status.counters;
        let encoder = Encoder::new(place, Lane::FromDrive)?;
        self.making = Some((encoder, Rest::Status(length)));
        Ok(())
    }

    /// Begins the frame of a block; its samples come in pieces.
    ///
    /// # Errors
    /// [`TooLong`]; never, as a block fits.
    pub fn begin_block(&mut self, place: P, block: &Block) -> Result<(), TooLong> {
        let mut encoder = Encoder::new(place, Lane::Telemetry)?;
        encoder.push(frame::write(&block.head(), &mut [0; Block::HEAD_BYTES])?)?;
        self.making = Some((encoder, Rest::Samples(0)));
        Ok(())
    }

    /// The first sample of the next piece, if a block is being made.
    pub fn next_sample(&self) -> Option<usize> {
        match self.making {
            Some((_, Rest::Samples(next))) => Some(next),
            _ => None,
        }
    }

    /// Goes on with these samples of the block; the frame, if they were its
    /// last.
    pub fn samples(&mut self, piece: &[Sample; PIECE_SAMPLES]) -> Option<Made<P>> {
        let (encoder, Rest::Samples(next)) = self.making.as_mut()? else {
            return None;
        };
        let mut bytes = [0; PIECE_SAMPLES * SAMPLE_BYTES];
        for (bytes, sample) in bytes.as_chunks_mut().0.iter_mut().zip(piece) {
            *bytes = sample.bytes();
        }
        encoder.push(&bytes).ok()?;
        *next = next.saturating_add(PIECE_SAMPLES);
        if *next < BLOCK_SAMPLES {
            return None;
        }
        self.finish()
    }

    /// Goes on with an answer or a status; the frame, if that was its end.
    pub fn piece(&mut self) -> Option<Made<P>> {
        let (encoder, rest) = self.making.as_mut()?;
        let is_whole = match rest {
            Rest::Answer(next) => {
                let left = self.answer.get(*next..)?;
                let piece = left.get(..PIECE_BYTES).unwrap_or(left);
                encoder.push(piece).ok()?;
                *next = next.saturating_add(PIECE_BYTES);
                *next >= self.answer.len()
            }
            Rest::Status(length) => {
                encoder.push(self.head.get(..*length)?).ok()?;
                *rest = Rest::Counters(0);
                false
            }
            Rest::Counters(next) => {
                let mut bytes = [0; PIECE_COUNTERS * COUNTER_BYTES];
                let mut length = 0_usize;
                for counter in self.counters.iter().skip(*next).take(PIECE_COUNTERS) {
                    let written = frame::write(counter, bytes.get_mut(length..)?).ok()?;
                    length = length.saturating_add(written.len());
                }
                encoder.push(bytes.get(..length)?).ok()?;
                *next = next.saturating_add(PIECE_COUNTERS);
                *next >= DRIVE_COUNT
            }
            Rest::Samples(_) => false,
        };
        if is_whole { self.finish() } else { None }
    }

    fn finish(&mut self) -> Option<Made<P>> {
        let (encoder, _) = self.making.take()?;
        encoder.finish().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::frame::{FRAME_BYTES, Frame};
    use crepitus_protocol::link::FromDrive;
    use crepitus_protocol::management::Identity;

    type Places = Outgoing<Place>;

    /// What a few runs make, and how many it takes.
    fn run(outgoing: &mut Places, block: &Block) -> (Frame, usize) {
        for runs in 1..100 {
            let made = match outgoing.next_sample() {
                Some(next) => {
                    let piece = block.samples[next..].first_chunk().unwrap();
                    outgoing.samples(piece)
                }
                None => outgoing.piece(),
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
        let place = || [0; FRAME_BYTES];
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
        outgoing.begin_status(place(), &status).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        let whole = FromDrive::Status(status);
        assert_eq!(frame, frame::encode(Lane::FromDrive, &whole).unwrap());
        assert!(runs <= 5, "{runs}");
        outgoing.begin_block(place(), &block).unwrap();
        let (frame, runs) = run(&mut outgoing, &block);
        assert_eq!(frame, frame::encode(Lane::Telemetry, &block).unwrap());
        assert_eq!(runs, BLOCK_SAMPLES / PIECE_SAMPLES);
        outgoing.begin_answer(place(), &answer).unwrap();
        let (frame, _) = run(&mut outgoing, &block);
        let whole = frame::encode_bytes(Lane::ManagementAnswer, &answer.bytes());
        assert_eq!(frame, whole.unwrap());
    }
}

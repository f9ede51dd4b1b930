//! The drive's end of the link: frames in, frames out.

use crate::counters::Counters;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::link::{DriveRefusal, DriveStatus, FromDrive, Outcome, ToDrive};
use crepitus_protocol::management::{Answer, Identity, Question, What};
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane};

use crate::drive::vigil::is_fresh;

/// Ticks between two statuses.
pub const STATUS_TICKS: u64 = 100;

/// What a byte has completed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Inbound {
    /// A message of comms.
    Message(ToDrive),
    /// A question of the lane that never changes.
    Management(Question),
}

/// The drive's end of the link.
#[derive(Clone, Debug, Default)]
pub struct Link {
    decoder: Decoder,
    /// The last command that was carried out, or is being.
    last: Option<Outcome>,
    in_hand: Option<u16>,
    answer: Option<Answer>,
    status_due: bool,
    next_status_tick: u64,
}

impl Link {
    /// Takes a byte from the wire.
    pub fn receive(&mut self, byte: u8, counters: &Counters) -> Option<Inbound> {
        let Ok(body) = self.decoder.push(byte)? else {
            counters.count(DriveCounter::Discarded);
            return None;
        };
        let inbound = match body.lane() {
            Some(Lane::ToDrive) => body.message().map(Inbound::Message),
            Some(Lane::Management) => Question::of(body.payload).map(Inbound::Management),
            _ => None,
        };
        counters.count(if inbound.is_some() {
            DriveCounter::Frames
        } else {
            DriveCounter::Foreign
        });
        inbound
    }

    /// Whether a command that echoes `seen_tick` is to be carried out now:
    /// newer than the last one, and fresh.
    pub fn accepts(&mut self, now: u64, seen_tick: u64, number: u16, counters: &Counters) -> bool {
        let last = self.in_hand.or(self.last.map(|outcome| outcome.number));
        if last == Some(number) {
            // Repeated: the status says what became of it.
            return false;
        }
        let is_newer = last.is_none_or(|last| number.wrapping_sub(last).cast_signed() > 0);
        if !(is_newer && is_fresh(now, seen_tick)) {
            counters.count(DriveCounter::StaleCommands);
            return false;
        }
        self.in_hand = Some(number);
        true
    }

    /// The command in hand is done, or refused.
    pub fn finish(&mut self, result: Result<(), DriveRefusal>) {
        if let Some(number) = self.in_hand.take() {
            self.last = Some(Outcome { number, result });
            self.status_due = true;
        }
    }

    /// Comms has started anew: its numbers begin anew, too.
    pub fn forget(&mut self) {
        (self.last, self.in_hand) = (None, None);
    }

    /// Answers a question once there is room.
    pub fn answer(&mut self, question: Question, own: &Identity, done: bool) {
        let token = question.token;
        self.answer = Some(match question.what {
            What::Hello => Answer::Hello {
                token,
                own: *own,
                drive: *own,
            },
            What::Stop => Answer::Stop { token, done },
            What::Reboot => Answer::Reboot { token, done },
        });
    }

    /// Something has changed: a status is due.
    pub fn changed(&mut self) {
        self.status_due = true;
    }

    /// The next frame for the wire: answers first, then the blocks that are
    /// complete, then what is due of the status: so a status tells of what
    /// comes after the blocks before it, a commit above all.
    pub fn next_frame(
        &mut self,
        now: u64,
        status: impl FnOnce(Option<Outcome>) -> DriveStatus,
        block: impl FnOnce() -> Option<Block>,
    ) -> Option<Frame> {
        if let Some(answer) = self.answer.take() {
            return frame::encode_bytes(Lane::ManagementAnswer, &answer.bytes()).ok();
        }
        if let Some(block) = block() {
            return frame::encode(Lane::Telemetry, &block).ok();
        }
        if self.status_due || now >= self.next_status_tick {
            self.status_due = false;
            self.next_status_tick = now.saturating_add(STATUS_TICKS);
            let status = FromDrive::Status(status(self.last));
            return frame::encode(Lane::FromDrive, &status).ok();
        }
        None
    }
}

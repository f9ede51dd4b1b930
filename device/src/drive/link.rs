//! What is known of the link: which command was carried out, what is due.

use crate::counters::Counters;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::link::{DriveRefusal, Outcome};
use crepitus_protocol::management::{Answer, Identity, Question, What};

use crate::drive::vigil::is_fresh;

/// Ticks between two statuses.
pub const STATUS_TICKS: u64 = 100;

/// Which command was carried out last, and what is due to be said.
#[derive(Debug, Default)]
pub struct Link {
    /// The last command that was carried out, or is being.
    last: Option<Outcome>,
    in_hand: Option<u16>,
    answer: Option<Answer>,
    status_due: bool,
    next_status_tick: u64,
}

impl Link {
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

    /// Whether a question waits for its answer.
    pub fn has_answer(&self) -> bool {
        self.answer.is_some()
    }

    /// The answer that waits.
    pub fn take_answer(&mut self) -> Option<Answer> {
        self.answer.take()
    }

    /// Whether a status is due.
    pub fn is_status_due(&self, now: u64) -> bool {
        self.status_due || now >= self.next_status_tick
    }

    /// A status is told now.
    pub fn status_told(&mut self, now: u64) {
        self.status_due = false;
        self.next_status_tick = now.saturating_add(STATUS_TICKS);
    }

    /// The last command that was carried out, or refused.
    pub fn last(&self) -> Option<Outcome> {
        self.last
    }
}

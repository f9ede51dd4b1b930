//! What the drive is sent, and when.

use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::link::{Heartbeat, Order, ToDrive};
use crepitus_protocol::management::{Question, What};
use crepitus_protocol::{Lane, Revision, Values};

/// What is not confirmed is sent again after this, ms.
const REPEAT_MS: u64 = 10;

/// Questions that are not answered are asked again after this, ms.
const HELLO_MS: u64 = 10;

/// What is due to the drive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToDriveQueue {
    now_ms: u64,
    heartbeat_due: bool,
    management: Option<Question>,
    commit_ms: Option<(Revision, u64)>,
    command_ms: Option<(u16, u64)>,
    hello_ms: u64,
    last_number: u16,
}

impl ToDriveQueue {
    /// A millisecond has gone by.
    pub(super) fn millisecond(&mut self, now_ms: u64) {
        self.now_ms = now_ms;
        self.heartbeat_due = true;
    }

    /// There is something to say that does not wait for the millisecond.
    pub(super) fn heartbeat_now(&mut self) {
        self.heartbeat_due = true;
    }

    /// A question of the lane that never changes.
    pub(super) fn ask(&mut self, what: What) {
        self.management = Some(Question { what, token: 0 });
    }

    /// A number for the next command.
    pub(super) fn next_number(&mut self) -> u16 {
        self.last_number = self.last_number.wrapping_add(1);
        self.last_number
    }

    /// The next frame: what must be heard first.
    pub(super) fn next_frame(
        &mut self,
        heartbeat: Heartbeat,
        commit: Option<(Revision, &Values)>,
        command: Option<(u16, Order)>,
        wants_hello: bool,
    ) -> Option<Frame> {
        if core::mem::take(&mut self.heartbeat_due) {
            return message(&ToDrive::Heartbeat(heartbeat));
        }
        if let Some(question) = self.management.take() {
            return frame::encode_bytes(Lane::Management, &question.bytes()).ok();
        }
        if let Some((number, order)) = command
            && self.is_due(
                self.command_ms
                    .filter(|(sent, _)| *sent == number)
                    .map(|s| s.1),
            )
        {
            self.command_ms = Some((number, self.now_ms));
            return message(&ToDrive::Command {
                seen_tick: heartbeat.seen_tick,
                number,
                order,
            });
        }
        if let Some((revision, values)) = commit
            && self.is_due(
                self.commit_ms
                    .filter(|(sent, _)| *sent == revision)
                    .map(|s| s.1),
            )
        {
            self.commit_ms = Some((revision, self.now_ms));
            return message(&ToDrive::Commit {
                revision,
                values: *values,
            });
        }
        if wants_hello && self.now_ms >= self.hello_ms {
            self.hello_ms = self.now_ms.saturating_add(HELLO_MS);
            let question = Question {
                what: What::Hello,
                token: 0,
            };
            return frame::encode_bytes(Lane::Management, &question.bytes()).ok();
        }
        None
    }

    fn is_due(&self, sent_ms: Option<u64>) -> bool {
        sent_ms.is_none_or(|sent_ms| self.now_ms >= sent_ms.saturating_add(REPEAT_MS))
    }
}

fn message(message: &ToDrive) -> Option<Frame> {
    frame::encode(Lane::ToDrive, message).ok()
}

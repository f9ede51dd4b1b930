//! Frames to the drive: priority and retry.

use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::link::{Heartbeat, Order, ToDrive};
use crepitus_protocol::management::{Action, ManagementRequest};
use crepitus_protocol::pieces::{self, Piece};
use crepitus_protocol::{Lane, Revision, Values};

/// Retry interval of unconfirmed messages, ms.
const RETRY_MS: u64 = 10;

/// Retry interval of questions: a hello, a part of the post-mortem record, ms.
const ASK_RETRY_MS: u64 = 10;

/// Pending frames to the drive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToDriveQueue {
    now_ms: u64,
    heartbeat_due: bool,
    management: Option<ManagementRequest>,
    commit: CommitProgress,
    command_ms: Option<(u16, u64)>,
    /// When it may be asked again for this.
    again_ms: u64,
    last_number: u16,
}

/// Pending messages to the drive, besides heartbeats.
pub(super) struct Wanted<'a> {
    pub(super) commit: Option<(Revision, &'a Values)>,
    pub(super) command: Option<(u16, Order)>,
    /// A part of its post-mortem record.
    pub(super) crash_part: Option<u8>,
    pub(super) hello: bool,
}

/// Progress of the commit that is being sent.
#[derive(Clone, Copy, Debug, Default)]
struct CommitProgress {
    revision: Option<Revision>,
    next: u8,
    /// The millisecond of the last piece. One in each: with a heartbeat that is less
    /// than the drive reads, and what it sends meanwhile has its runs.
    sent_ms: Option<u64>,
}

impl CommitProgress {
    /// Returns the piece to send now, and how many there are. Starts over when the
    /// commit is not confirmed in time.
    fn next_piece(
        &mut self,
        now_ms: u64,
        revision: Revision,
        values: &Values,
    ) -> Option<(Piece, u8)> {
        if self.revision != Some(revision) {
            (self.revision, self.next) = (Some(revision), 0);
        }
        let since = |ms: u64| now_ms.saturating_sub(ms);
        if self.sent_ms.is_some_and(|ms| since(ms) == 0) {
            return None;
        }
        let pieces = pieces::to_send(&values.0);
        let left = pieces & u32::MAX.unbounded_shl(self.next.into());
        let first = match left {
            0 if self.sent_ms.is_some_and(|ms| since(ms) < RETRY_MS) => return None,
            0 => pieces,
            left => left,
        };
        let [index, ..] = first.trailing_zeros().to_le_bytes();
        let [count, ..] = pieces.count_ones().to_le_bytes();
        let piece = Piece::of(&values.0, index)?;
        self.next = index.saturating_add(1);
        self.sent_ms = Some(now_ms);
        Some((piece, count))
    }
}

impl ToDriveQueue {
    /// Runs once a millisecond.
    pub(super) fn tick(&mut self, now_ms: u64) {
        self.now_ms = now_ms;
        self.heartbeat_due = true;
    }

    /// Sends a heartbeat before the next millisecond.
    pub(super) fn heartbeat_now(&mut self) {
        self.heartbeat_due = true;
    }

    /// Queues a management request.
    pub(super) fn queue_management(&mut self, action: Action) {
        self.management = Some(ManagementRequest { action, token: 0 });
    }

    /// Sequence number for the next command.
    pub(super) fn next_number(&mut self) -> u16 {
        self.last_number = self.last_number.wrapping_add(1);
        self.last_number
    }

    /// Returns the next frame, the most urgent first.
    pub(super) fn next_frame(
        &mut self,
        heartbeat: Heartbeat,
        wanted: &Wanted<'_>,
    ) -> Option<Frame> {
        if core::mem::take(&mut self.heartbeat_due) {
            return message(&ToDrive::Heartbeat(heartbeat));
        }
        if let Some(question) = self.management.take() {
            return frame::encode_bytes(Lane::Management, &question.bytes()).ok();
        }
        if let Some((number, order)) = wanted.command
            && self.command_ms.is_none_or(|(sent, sent_ms)| {
                sent != number || self.now_ms >= sent_ms.saturating_add(RETRY_MS)
            })
        {
            self.command_ms = Some((number, self.now_ms));
            return message(&ToDrive::Command {
                seen_tick: heartbeat.seen_tick,
                number,
                order,
            });
        }
        if let Some((revision, values)) = wanted.commit
            && let Some((piece, pieces)) = self.commit.next_piece(self.now_ms, revision, values)
        {
            return message(&ToDrive::Commit {
                revision,
                checksum: pieces::checksum(&values.0),
                pieces,
                piece,
            });
        }
        if self.now_ms < self.again_ms {
            return None;
        }
        if let Some(part) = wanted.crash_part {
            self.again_ms = self.now_ms.saturating_add(ASK_RETRY_MS);
            return message(&ToDrive::ReadCrash { part });
        }
        if wanted.hello {
            self.again_ms = self.now_ms.saturating_add(ASK_RETRY_MS);
            let question = ManagementRequest {
                action: Action::Hello,
                token: 0,
            };
            return frame::encode_bytes(Lane::Management, &question.bytes()).ok();
        }
        None
    }
}

fn message(message: &ToDrive) -> Option<Frame> {
    frame::encode(Lane::ToDrive, message).ok()
}

//! Frames to the drive: priority and retry.

use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::link::{Heartbeat, Order, ToDrive};
use crepitus_protocol::management::{Action, ManagementRequest};
use crepitus_protocol::pieces::{self, Piece};
use crepitus_protocol::{Lane, Revision, Values};

/// Retry interval of unconfirmed messages, ms.
const RETRY_MS: u64 = 10;

/// Pieces of a commit in a millisecond: with a heartbeat these are 145 bytes. The
/// drive reads 100, and its ring has place for all pieces of a commit.
const PIECES_PER_MS: u8 = 2;

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
    /// The last millisecond with a piece, and how many.
    sent_ms: u64,
    sent: u8,
}

impl CommitProgress {
    /// Returns the piece to send now. Starts over when the commit is not confirmed
    /// in time.
    fn next_piece(&mut self, now_ms: u64, revision: Revision, values: &Values) -> Option<Piece> {
        if self.revision != Some(revision) {
            (self.revision, self.next) = (Some(revision), 0);
        }
        let sent = if now_ms > self.sent_ms { 0 } else { self.sent };
        if sent >= PIECES_PER_MS {
            return None;
        }
        let piece = match Piece::of(&values.0, self.next) {
            None if now_ms < self.sent_ms.saturating_add(RETRY_MS) => return None,
            None => Piece::of(&values.0, 0)?,
            Some(piece) => piece,
        };
        self.next = piece.index.saturating_add(1);
        (self.sent_ms, self.sent) = (now_ms, sent.saturating_add(1));
        Some(piece)
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
            && let Some(piece) = self.commit.next_piece(self.now_ms, revision, values)
        {
            return message(&ToDrive::Commit {
                revision,
                checksum: pieces::checksum(&values.0),
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

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
    /// Earliest time of the next question, ms.
    again_ms: u64,
    last_number: u16,
    /// Number of the last heartbeat.
    heartbeat: u8,
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

    /// Returns the next frame, the most urgent first; it numbers heartbeats.
    pub(super) fn next_frame(
        &mut self,
        heartbeat: Heartbeat,
        wanted: &Wanted<'_>,
    ) -> Option<Frame> {
        if core::mem::take(&mut self.heartbeat_due) {
            self.heartbeat = self.heartbeat.wrapping_add(1);
            return message(&ToDrive::Heartbeat(Heartbeat {
                number: self.heartbeat,
                ..heartbeat
            }));
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
                seal: pieces::seal(&values.0, heartbeat.start),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::Decoder;
    use std::vec::Vec;

    const NOTHING: Wanted<'static> = Wanted {
        commit: None,
        command: None,
        crash_part: None,
        hello: false,
    };

    /// The message in a frame.
    #[derive(Debug, PartialEq)]
    enum Sent {
        Heartbeat,
        Command(u16),
        Piece(u8),
        CrashPart(u8),
        Asked(Action),
    }

    fn sent(frame: &Frame) -> Sent {
        let mut decoder = Decoder::new();
        let (_, body) = decoder.extend(frame);
        let body = body.unwrap().unwrap();
        if body.lane() == Some(Lane::Management) {
            return Sent::Asked(ManagementRequest::of(body.payload).unwrap().action);
        }
        match body.message().unwrap() {
            ToDrive::Heartbeat(_) => Sent::Heartbeat,
            ToDrive::Command { number, .. } => Sent::Command(number),
            ToDrive::Commit { piece, .. } => Sent::Piece(piece.index),
            ToDrive::ReadCrash { part } => Sent::CrashPart(part),
        }
    }

    /// The frames of each of so many milliseconds.
    fn run(
        queue: &mut ToDriveQueue,
        from_ms: u64,
        count: u64,
        wanted: &Wanted<'_>,
    ) -> Vec<Vec<Sent>> {
        let heartbeat = Heartbeat {
            seen_tick: 5,
            lease_left: 9,
            enable: false,
            start: 1,
            number: 0,
        };
        (from_ms..from_ms + count)
            .map(|now_ms| {
                queue.tick(now_ms);
                let mut frames = Vec::new();
                while let Some(frame) = queue.next_frame(heartbeat, wanted) {
                    frames.push(sent(&frame));
                    assert!(frames.len() < 10, "without an end: {frames:?}");
                }
                frames
            })
            .collect()
    }

    /// The milliseconds in which something else than a heartbeat was sent.
    fn when(frames: &[Vec<Sent>]) -> Vec<usize> {
        frames
            .iter()
            .enumerate()
            .filter_map(|(ms, frames)| {
                assert_eq!(frames[0], Sent::Heartbeat);
                (frames.len() > 1).then_some(ms)
            })
            .collect()
    }

    #[test]
    fn a_heartbeat_goes_each_millisecond_and_once_more_when_asked_for() {
        let mut queue = ToDriveQueue::default();
        for frames in run(&mut queue, 0, 30, &NOTHING) {
            assert_eq!(frames, [Sent::Heartbeat]);
        }
        queue.heartbeat_now();
        let heartbeat = Heartbeat {
            seen_tick: 5,
            lease_left: 0,
            enable: false,
            start: 1,
            number: 0,
        };
        let frame = queue.next_frame(heartbeat, &NOTHING);
        assert_eq!(frame.map(|frame| sent(&frame)), Some(Sent::Heartbeat));
        assert!(queue.next_frame(heartbeat, &NOTHING).is_none());
    }

    #[test]
    fn a_command_is_repeated_every_ten_milliseconds_and_another_goes_at_once() {
        let mut queue = ToDriveQueue::default();
        let command = |number| Wanted {
            command: Some((number, Order::Zero)),
            ..NOTHING
        };
        let frames = run(&mut queue, 100, 25, &command(4));
        assert_eq!(when(&frames), [0, 10, 20]);
        assert_eq!(frames[10][1], Sent::Command(4));
        let frames = run(&mut queue, 125, 12, &command(5));
        assert_eq!(when(&frames), [0, 10]);
    }

    #[test]
    fn a_commit_goes_a_piece_a_millisecond_and_again_ten_after_the_last() {
        let mut queue = ToDriveQueue::default();
        let mut values = Values::default();
        values.0[0] = 0.25;
        values.0[9] = 0.25;
        let wanted = |revision| Wanted {
            commit: Some((Revision(revision), &values)),
            ..NOTHING
        };
        let frames = run(&mut queue, 100, 24, &wanted(3));
        assert_eq!(when(&frames), [0, 1, 11, 12, 22, 23]);
        assert_eq!(frames[0][1..], [Sent::Piece(0)]);
        assert_eq!(frames[12][1..], [Sent::Piece(2)]);
        // A newer commit starts with its first piece, without waiting.
        let frames = run(&mut queue, 124, 3, &wanted(4));
        assert_eq!(when(&frames), [0, 1]);
        assert_eq!(frames[0][1..], [Sent::Piece(0)]);
    }

    #[test]
    fn questions_wait_for_ten_milliseconds_and_come_after_all_else() {
        let mut queue = ToDriveQueue::default();
        let hello = Wanted {
            hello: true,
            ..NOTHING
        };
        let frames = run(&mut queue, 100, 21, &hello);
        assert_eq!(when(&frames), [0, 10, 20]);
        assert_eq!(frames[0][1..], [Sent::Asked(Action::Hello)]);
        let all = Wanted {
            command: Some((1, Order::Zero)),
            crash_part: Some(2),
            ..hello
        };
        let frames = run(&mut queue, 130, 1, &all);
        assert_eq!(frames[0][1..], [Sent::Command(1), Sent::CrashPart(2)]);
        queue.queue_management(Action::Stop);
        let frames = run(&mut queue, 131, 2, &all);
        assert_eq!(frames[0][1..], [Sent::Asked(Action::Stop)]);
        assert_eq!(frames[1], [Sent::Heartbeat]);
    }
}

//! Messages to the drive, and the notes of the oracle on what it receives.

use super::Bench;
use super::readings::Readings;
use crepitus_protocol::link::{Heartbeat, Order, STALE_TICKS, ToDrive};
use crepitus_protocol::pieces::{self, Piece};
use crepitus_protocol::{HEARTBEAT_TICKS, Lane, Revision, State, Values, frame};

/// The most milliseconds that a drive in order takes from a commit to its revision.
const MOST_PREPARING_MS: u32 = 20;

impl Bench {
    /// All that arming needs.
    pub(super) fn arm(&mut self) {
        let revision = Revision(1);
        self.commit(revision, &Values::default());
        // The drive prepares values between its ticks, some of them in each.
        for _ in 0..MOST_PREPARING_MS {
            self.heartbeat(5_000);
            self.run(20, &Readings::good());
            if self.drive.revision() == revision {
                break;
            }
        }
        self.heartbeat(5_000);
        for order in [Order::ClearFault, Order::Zero, Order::Arm] {
            self.number = self.number.wrapping_add(1);
            self.send(&ToDrive::Command {
                seen_tick: self.drive.next_tick(),
                number: self.number,
                order,
            });
        }
    }

    pub(super) fn heartbeat(&mut self, lease_left: u16) {
        self.beat = self.beat.wrapping_add(1);
        self.send(&ToDrive::Heartbeat(Heartbeat {
            seen_tick: self.drive.next_tick(),
            lease_left,
            enable: true,
            start: 0,
            number: self.beat,
        }));
    }

    pub(super) fn commit(&mut self, revision: Revision, values: &Values) {
        self.sent.push((revision, *values));
        let send = pieces::to_send(&values.0);
        let [count, ..] = send.count_ones().to_le_bytes();
        let all = (0..).map_while(|index| Piece::of(&values.0, index));
        for piece in all.filter(|piece| send >> piece.index & 1 == 1) {
            self.send(&ToDrive::Commit {
                revision,
                seal: pieces::seal(&values.0, 0),
                pieces: count,
                piece,
            });
        }
    }

    pub(super) fn send(&mut self, message: &ToDrive) {
        let frame = frame::encode(Lane::ToDrive, message).expect("every message fits");
        self.receive(&frame);
    }

    /// Bytes for the drive, and for the oracle.
    pub(super) fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let message = match self.ear.push(*byte) {
                Some(Ok(body)) if body.lane() == Some(Lane::ToDrive) => body.message(),
                _ => None,
            };
            let (before, now) = (self.drive.state(), self.drive.next_tick());
            self.drive.link_received(*byte);
            let after = self.drive.state();
            let order = match &message {
                Some(ToDrive::Command { order, .. }) => Some(*order),
                _ => None,
            };
            assert!(
                before != State::Faulted || after == before || order == Some(Order::ClearFault),
                "{message:?} clears a fault"
            );
            assert!(
                before == after || after != State::Armed,
                "armed at once by {message:?}"
            );
            assert!(
                before == after || after != State::Arming || order == Some(Order::Arm),
                "{message:?} arms"
            );
            if let Some(ToDrive::Heartbeat(heartbeat)) = message {
                self.note(now, &heartbeat);
            }
        }
    }

    fn note(&mut self, now: u64, heartbeat: &Heartbeat) {
        self.has_restarted |= heartbeat.start != 0;
        let seen = heartbeat.seen_tick;
        let is_new = self.last_beat.is_none_or(|(start, number)| {
            let ahead = heartbeat.number.wrapping_sub(number);
            let is_silent =
                (self.comms_start).is_none_or(|last| now.saturating_sub(last) >= HEARTBEAT_TICKS);
            start != heartbeat.start || (1..128).contains(&ahead) || is_silent && ahead != 0
        });
        if is_new && seen <= now && now - seen <= STALE_TICKS {
            self.last_beat = Some((heartbeat.start, heartbeat.number));
            self.comms_start = Some(now);
            self.lease_end = seen.saturating_add(u64::from(heartbeat.lease_left));
            if !heartbeat.enable {
                let state = self.drive.state();
                assert!(matches!(state, State::Disarmed | State::Faulted));
            }
        }
    }
}

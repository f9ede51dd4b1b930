//! The state of the drive as comms last received it.

use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::link::{DriveStatus, Outcome};
use crepitus_protocol::management::Identity;
use crepitus_protocol::task_times::TaskTimes;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, State, ValueError};

/// Timeout: without a block for this long the drive counts as silent, ms.
pub const SILENT_MS: u64 = 5;

/// Continuity of a block with the stream before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// A new block.
    Next {
        /// Samples lost on the link before it.
        lost: u32,
    },
    /// A block that was received before.
    Stale,
    /// The first block after a restart of the drive.
    Restarted,
}

/// The state of the drive as comms last received it.
#[derive(Clone, Copy, Debug, Default)]
pub struct DriveView {
    identity: Option<Identity>,
    /// Time of the last block, ms.
    last_block_ms: Option<u64>,
    /// The lowest bits of the drive's boot counter.
    start: Option<u8>,
    /// A status has shown that these are those of another boot by chance.
    is_other_boot: bool,
    /// The tick after its last block.
    next_tick: u64,
    /// Samples that the drive itself had dropped up to its last block.
    dropped: u32,
    status: Option<DriveStatus>,
    /// Times of its tasks, as of its last report since its start.
    times: Option<TaskTimes>,
}

impl DriveView {
    /// Receives a block.
    pub fn receive_block(&mut self, block: &Block, now_ms: u64) -> Continuity {
        let start = block.flags.start();
        let continuity = match self.start {
            None => {
                // The first block: the drive may have been replaced or reprogrammed.
                self.identity = None;
                Continuity::Next { lost: 0 }
            }
            Some(known) if known != start || self.is_other_boot => {
                // The drive has restarted: everything received before is stale.
                *self = Self::default();
                Continuity::Restarted
            }
            Some(_) if block.first_tick < self.next_tick => return Continuity::Stale,
            Some(_) => {
                let missing = block.first_tick.saturating_sub(self.next_tick);
                let dropped = block.dropped.wrapping_sub(self.dropped);
                let lost = missing.saturating_sub(u64::from(dropped));
                Continuity::Next {
                    lost: u32::try_from(lost).unwrap_or(u32::MAX),
                }
            }
        };
        self.start = Some(start);
        self.last_block_ms = Some(now_ms);
        self.next_tick = block.end_tick();
        self.dropped = block.dropped;
        continuity
    }

    /// Receives a status. A status from another boot than the blocks is ignored:
    /// the next block will report the restart.
    ///
    /// After power was off the boot counter is random, so in one case of 32 its lowest bits are
    /// those of before, and blocks look stale. Statuses have all of it.
    pub fn receive_status(&mut self, status: &DriveStatus) {
        let [low, _] = status.start.to_le_bytes();
        if self.start != Some(low & 31) {
            return;
        }
        self.is_other_boot = (self.status).is_some_and(|old| status.start != old.start);
        let is_newer = self.status.is_none_or(|old| status.tick >= old.tick);
        if is_newer && !self.is_other_boot {
            self.status = Some(*status);
        }
    }

    /// Stores the times of its tasks.
    pub fn receive_times(&mut self, times: &TaskTimes) {
        self.times = Some(*times);
    }

    /// Times of its tasks, if it has reported any since its start.
    pub fn times(&self) -> Option<TaskTimes> {
        self.times
    }

    /// Stores the drive's identity.
    pub fn set_identity(&mut self, identity: &Identity) {
        self.identity = Some(*identity);
    }

    /// The drive's identity, once received.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// The lowest bits of its start, as in the flags of its blocks, if one was
    /// ever received.
    pub fn start(&self) -> Option<u8> {
        self.start
    }

    /// Returns whether blocks arrive within the timeout.
    pub fn is_present(&self, now_ms: u64) -> bool {
        self.last_block_ms
            .is_some_and(|last_ms| now_ms.saturating_sub(last_ms) < SILENT_MS)
    }

    /// The latest tick that the drive has reported.
    pub fn seen_tick(&self) -> u64 {
        self.status
            .map_or(self.next_tick, |status| status.tick.max(self.next_tick))
    }

    /// The tick after the last block.
    pub fn next_tick(&self) -> u64 {
        self.next_tick
    }

    /// The drive's last status.
    pub fn status(&self) -> Option<&DriveStatus> {
        self.status.as_ref()
    }

    /// The drive's state, as of its last status.
    pub fn state(&self) -> State {
        self.status.map_or(State::Disarmed, |status| status.state)
    }

    /// Returns whether its arming waits for the enable line of comms, or has it.
    pub fn awaits_comms(&self) -> bool {
        self.status.is_some_and(|status| status.awaits_comms)
    }

    /// The active parameters, if the drive is present and has reported anything.
    pub fn revision(&self, now_ms: u64, start: u16) -> Option<Revision> {
        self.status.filter(|_| self.is_present(now_ms))?;
        Some(self.known_revision(start))
    }

    /// The active parameters; none until the drive has reported some of this boot of comms.
    /// Revisions of an earlier boot may have the same number.
    pub fn known_revision(&self, start: u16) -> Revision {
        self.status_since(start)
            .map_or(Revision::NONE, |status| status.revision)
    }

    /// The commit that the drive has rejected since this boot of comms.
    pub fn refused(&self, start: u16) -> Option<(Revision, ValueError)> {
        self.status_since(start).and_then(|status| status.refused)
    }

    /// Result of the last command since this boot of comms.
    pub fn outcome(&self, start: u16) -> Option<Outcome> {
        self.status_since(start).and_then(|status| status.last)
    }

    /// The drive's counters.
    pub fn counters(&self) -> [u32; DRIVE_COUNT] {
        self.status
            .map_or([0; DRIVE_COUNT], |status| status.counters)
    }

    fn status_since(&self, start: u16) -> Option<&DriveStatus> {
        self.status
            .as_ref()
            .filter(|status| status.comms_start == Some(start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::telemetry::BlockFlags;

    fn block(first_tick: u64, dropped: u32, start: u16) -> Block {
        Block {
            first_tick,
            dropped,
            flags: BlockFlags::new(State::Disarmed, false, start),
            ..Block::default()
        }
    }

    #[test]
    fn missing_samples_are_dropped_or_lost() {
        let mut view = DriveView::default();
        assert_eq!(
            view.receive_block(&block(5_000, 0, 1), 1),
            Continuity::Next { lost: 0 }
        );
        assert_eq!(
            view.receive_block(&block(5_020, 0, 1), 2),
            Continuity::Next { lost: 0 }
        );
        // Three blocks missing, one of them reported as dropped by the drive.
        assert_eq!(
            view.receive_block(&block(5_100, 20, 1), 6),
            Continuity::Next { lost: 40 }
        );
        assert_eq!(
            view.receive_block(&block(5_100, 20, 1), 6),
            Continuity::Stale
        );
        assert_eq!(
            view.receive_block(&block(5_080, 20, 1), 6),
            Continuity::Stale
        );
        assert!(view.is_present(10) && !view.is_present(11));
        assert_eq!(view.seen_tick(), 5_120);
    }

    #[test]
    fn a_restart_clears_the_view() {
        let mut view = DriveView::default();
        view.receive_block(&block(5_000, 0, 1), 1);
        view.set_identity(&Identity::default());
        let status = DriveStatus {
            tick: 5_030,
            start: 1,
            revision: Revision(3),
            comms_start: Some(9),
            ..DriveStatus::default()
        };
        assert_eq!(view.revision(1, 9), None);
        view.receive_status(&status);
        assert_eq!(
            (view.seen_tick(), view.revision(1, 9)),
            (5_030, Some(Revision(3)))
        );
        // Another start of comms has numbers of its own.
        assert_eq!(view.revision(1, 10), Some(Revision::NONE));
        assert_eq!(
            view.receive_block(&block(0, 0, 2), 3),
            Continuity::Restarted
        );
        assert_eq!(view.identity(), None);
        view.receive_status(&status);
        assert_eq!(
            (view.seen_tick(), view.revision(3, 9)),
            (20, None),
            "of another life"
        );
    }

    /// A boot counter that is random may have the same lowest bits.
    #[test]
    fn another_boot_with_the_same_lowest_bits_is_a_restart() {
        for tick in [40, 90_000] {
            let mut view = DriveView::default();
            view.receive_block(&block(5_000, 0, 1), 1);
            let status = DriveStatus {
                tick: 5_030,
                start: 1,
                ..DriveStatus::default()
            };
            view.receive_status(&status);
            let other = DriveStatus {
                tick,
                start: 33,
                ..status
            };
            view.receive_status(&other);
            assert_eq!(view.status(), Some(&status), "not of this boot");
            let first = block(tick, 0, 33);
            assert_eq!(view.receive_block(&first, 3), Continuity::Restarted);
            assert!(view.is_present(3) && view.status().is_none());
            view.receive_status(&other);
            assert_eq!(view.status(), Some(&other));
            let next = block(tick + 20, 0, 33);
            let continuity = view.receive_block(&next, 4);
            assert_eq!(continuity, Continuity::Next { lost: 0 });
        }
    }
}

//! What comms knows of the drive.

use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::link::{DriveStatus, Outcome};
use crepitus_protocol::management::Identity;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, State, ValueError};

/// After so long without a block the drive is silent, ms.
pub const SILENT_MS: u64 = 5;

/// What a block tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// The next one; so many samples before it were lost on the link.
    Next {
        /// Samples lost on the link.
        lost: u32,
    },
    /// One that was here before.
    Old,
    /// The first one of another start of the drive.
    Restarted,
}

/// What comms knows of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct DriveView {
    identity: Option<Identity>,
    /// When the last block came, ms.
    heard_ms: Option<u64>,
    /// The lowest bits of the number of its start.
    start: Option<u8>,
    /// The tick after its last block.
    next_tick: u64,
    /// Samples that the drive itself had dropped by then.
    dropped: u32,
    status: Option<DriveStatus>,
}

impl DriveView {
    /// Takes a block.
    pub fn hear_block(&mut self, block: &Block, now_ms: u64) -> News {
        let start = block.flags.start();
        let news = match self.start {
            None => {
                // Heard for the first time: it may be another than it was.
                self.identity = None;
                News::Next { lost: 0 }
            }
            Some(known) if known != start => {
                // All that was known of it is of another life.
                *self = Self::default();
                News::Restarted
            }
            Some(_) if block.first_tick < self.next_tick => return News::Old,
            Some(_) => {
                let missing = block.first_tick.saturating_sub(self.next_tick);
                let dropped = block.dropped.wrapping_sub(self.dropped);
                let lost = missing.saturating_sub(u64::from(dropped));
                News::Next {
                    lost: u32::try_from(lost).unwrap_or(u32::MAX),
                }
            }
        };
        self.start = Some(start);
        self.heard_ms = Some(now_ms);
        self.next_tick = block.end_tick();
        self.dropped = block.dropped;
        news
    }

    /// Takes a status. One of another start than the blocks is not believed:
    /// the next block will say so.
    pub fn hear_status(&mut self, status: &DriveStatus) {
        let [low, _] = status.start.to_le_bytes();
        let is_newer = self.status.is_none_or(|old| status.tick >= old.tick);
        if self.start == Some(low & 31) && is_newer {
            self.status = Some(*status);
        }
    }

    /// Who it is.
    pub fn introduce(&mut self, identity: &Identity) {
        self.identity = Some(*identity);
    }

    /// Who it is, if it has said so.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Whether it was ever heard.
    pub fn is_known(&self) -> bool {
        self.start.is_some()
    }

    /// Whether blocks come.
    pub fn is_present(&self, now_ms: u64) -> bool {
        self.heard_ms
            .is_some_and(|heard| now_ms.saturating_sub(heard) < SILENT_MS)
    }

    /// The drive's tick, as far as it is known.
    pub fn seen_tick(&self) -> u64 {
        self.status
            .map_or(self.next_tick, |status| status.tick.max(self.next_tick))
    }

    /// The tick after the last block.
    pub fn next_tick(&self) -> u64 {
        self.next_tick
    }

    /// Its last status.
    pub fn status(&self) -> Option<&DriveStatus> {
        self.status.as_ref()
    }

    /// Its state, as of its last status.
    pub fn state(&self) -> State {
        self.status.map_or(State::Disarmed, |status| status.state)
    }

    /// The parameters in force, if it is there and has said so.
    pub fn revision(&self, now_ms: u64) -> Option<Revision> {
        self.status
            .filter(|_| self.is_present(now_ms))
            .map(|status| status.revision)
    }

    /// The commit that it has refused, if it has heard this start of comms.
    pub fn refused(&self, start: u16) -> Option<(Revision, ValueError)> {
        self.heard(start).and_then(|status| status.refused)
    }

    /// What became of the last command, if it has heard this start of comms.
    pub fn outcome(&self, start: u16) -> Option<Outcome> {
        self.heard(start).and_then(|status| status.last)
    }

    /// What it has counted.
    pub fn counters(&self) -> [u32; DRIVE_COUNT] {
        self.status
            .map_or([0; DRIVE_COUNT], |status| status.counters)
    }

    fn heard(&self, start: u16) -> Option<&DriveStatus> {
        self.status
            .as_ref()
            .filter(|status| status.heard == Some(start))
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
    fn what_is_missing_was_dropped_or_lost() {
        let mut view = DriveView::default();
        assert_eq!(
            view.hear_block(&block(5_000, 0, 1), 1),
            News::Next { lost: 0 }
        );
        assert_eq!(
            view.hear_block(&block(5_020, 0, 1), 2),
            News::Next { lost: 0 }
        );
        // Three blocks missing, one of which the drive says it dropped.
        assert_eq!(
            view.hear_block(&block(5_100, 20, 1), 6),
            News::Next { lost: 40 }
        );
        assert_eq!(view.hear_block(&block(5_100, 20, 1), 6), News::Old);
        assert_eq!(view.hear_block(&block(5_080, 20, 1), 6), News::Old);
        assert!(view.is_present(10) && !view.is_present(11));
        assert_eq!(view.seen_tick(), 5_120);
    }

    #[test]
    fn another_start_forgets_what_was_known() {
        let mut view = DriveView::default();
        view.hear_block(&block(5_000, 0, 1), 1);
        view.introduce(&Identity::default());
        let status = DriveStatus {
            tick: 5_030,
            start: 1,
            revision: Revision(3),
            ..DriveStatus::default()
        };
        view.hear_status(&status);
        assert_eq!(
            (view.seen_tick(), view.revision(1)),
            (5_030, Some(Revision(3)))
        );
        assert_eq!(view.hear_block(&block(0, 0, 2), 3), News::Restarted);
        assert_eq!(view.identity(), None);
        view.hear_status(&status);
        assert_eq!(
            (view.seen_tick(), view.revision(3)),
            (20, None),
            "of another life"
        );
    }
}

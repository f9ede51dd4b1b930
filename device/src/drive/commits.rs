//! Assembly of commits that the link receives, for the idle loop.

use crate::counters::Counters;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::pieces::{Piece, Reassembly};
use crepitus_protocol::{Revision, ValueError, Values};

/// Received commits and their outcomes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commits {
    /// The latest commit, until its preparation begins, and its pieces.
    pending: Option<Revision>,
    reassembly: Reassembly,
    /// The latest revision received since this boot of comms.
    latest: Option<Revision>,
    /// The revision prepared last; it takes effect with a block.
    prepared: Option<Revision>,
    /// The last rejected revision, and the reason.
    refused: Option<(Revision, ValueError)>,
}

impl Commits {
    /// Handles a piece of a commit; `active` is the current revision. Returns whether
    /// its outcome is decided already, so that comms should hear of it.
    pub fn receive(
        &mut self,
        revision: Revision,
        (checksum, pieces): (u32, u8),
        piece: &Piece,
        active: Revision,
        counters: &Counters,
    ) -> bool {
        let is_older = |latest: Revision| revision.0.wrapping_sub(latest.0).cast_signed() < 0;
        // Stale: a later commit has overtaken it. NONE is no valid revision.
        if revision == Revision::NONE || self.latest.is_some_and(is_older) {
            counters.count(DriveCounter::StaleCommands);
            return true;
        }
        self.latest = Some(revision);
        // Comms repeats a commit until its outcome is confirmed.
        let is_known = active == revision
            || self.prepared == Some(revision)
            || self.refused.is_some_and(|(refused, _)| refused == revision);
        if is_known {
            return true;
        }
        if self.pending != Some(revision) || self.reassembly.checksum() != checksum {
            self.pending = Some(revision);
            self.reassembly.restart(checksum, pieces);
        }
        self.reassembly.add(piece);
        false
    }

    /// Takes the pending commit once complete, and copies it to `gathered`; see
    /// [`Self::verified`]. In one copy: the link waits meanwhile.
    pub fn take_into(&mut self, gathered: &mut Reassembly) -> Option<Revision> {
        let complete = self.pending.take_if(|_| self.reassembly.is_complete())?;
        *gathered = self.reassembly;
        Some(complete)
    }

    /// Returns the values of a commit if its checksum is valid; comms repeats an
    /// invalid one. The checksum takes long, so call this outside a lock.
    pub fn verified(reassembly: &Reassembly, counters: &Counters) -> Option<Values> {
        let values = reassembly.values().map(Values);
        if values.is_none() {
            counters.count(DriveCounter::Discarded);
        }
        values
    }

    /// Records that a commit was prepared, and will take effect, or rejected.
    pub fn done(
        &mut self,
        revision: Revision,
        result: Result<(), ValueError>,
        counters: &Counters,
    ) {
        match result {
            Ok(()) => (self.prepared, self.refused) = (Some(revision), None),
            Err(error) => {
                counters.count(DriveCounter::RefusedCommits);
                self.refused = Some((revision, error));
            }
        }
    }

    /// The last rejected revision, and the reason.
    pub fn refused(&self) -> Option<(Revision, ValueError)> {
        self.refused
    }

    /// Resets after a restart of comms, whose revisions restart, too. A prepared
    /// commit still takes effect.
    pub fn clear(&mut self) {
        (self.pending, self.latest, self.refused) = (None, None, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::parameters::{PARAMETER_COUNT, id};
    use crepitus_protocol::pieces::{PIECE_VALUES, checksum};

    /// Every piece is sent, also those at their defaults.
    #[expect(clippy::cast_possible_truncation, reason = "less than 32")]
    const ALL: u8 = PARAMETER_COUNT.div_ceil(PIECE_VALUES) as u8;

    /// What arrives of a commit.
    struct Wire {
        counters: Counters,
        commits: Commits,
    }

    impl Wire {
        fn new() -> Self {
            Self {
                counters: Counters::new(),
                commits: Commits::default(),
            }
        }

        fn piece(&mut self, revision: u32, values: &Values, index: u8, active: u32) -> bool {
            let piece = Piece::of(&values.0, index);
            if let Some(piece) = &piece {
                let sum = checksum(&values.0);
                self.commits.receive(
                    Revision(revision),
                    (sum, ALL),
                    piece,
                    Revision(active),
                    &self.counters,
                );
            }
            piece.is_some()
        }

        fn whole(&mut self, revision: u32, values: &Values, active: u32) {
            let mut index = 0;
            while self.piece(revision, values, index, active) {
                index += 1;
            }
            assert!(index > 1, "several pieces");
        }

        fn take(&mut self) -> Option<(Revision, Values)> {
            let mut gathered = Reassembly::default();
            let revision = self.commits.take_into(&mut gathered)?;
            Some((revision, Commits::verified(&gathered, &self.counters)?))
        }
    }

    #[test]
    fn revision_none_is_rejected() {
        let mut wire = Wire::new();
        wire.piece(Revision::NONE.0, &Values::default(), 0, 4);
        assert_eq!(wire.commits.pending, None);
        assert_eq!(wire.counters.get(DriveCounter::StaleCommands), 1);
    }

    #[test]
    fn a_commit_is_taken_once_however_often_it_is_received() {
        let mut wire = Wire::new();
        let values = Values::default();
        for _ in 0..3 {
            wire.whole(5, &values, 4);
        }
        assert_eq!(wire.take(), Some((Revision(5), values)));
        wire.commits.done(Revision(5), Ok(()), &wire.counters);
        wire.whole(5, &values, 4);
        assert_eq!(wire.take(), None);
        // One that was overtaken does not come back.
        wire.whole(4, &values, 5);
        assert_eq!(wire.take(), None);
        assert!(wire.counters.get(DriveCounter::StaleCommands) > 0);
        // A rejected revision stays rejected until comms restarts.
        let why = ValueError::NeedsDisarmed { id: 6 };
        wire.commits.done(Revision(6), Err(why), &wire.counters);
        wire.whole(6, &values, 5);
        assert_eq!(wire.take(), None);
        assert_eq!(wire.commits.refused(), Some((Revision(6), why)));
        wire.commits.clear();
        wire.whole(2, &values, 5);
        assert!(wire.take().is_some());
    }

    #[test]
    fn pieces_of_two_commits_are_never_one() {
        let (old, mut new) = (Values::default(), Values::default());
        new.set(id::STATIC_TORQUE, 0.5);
        new.set(id::TORQUE_LIMIT, 3.0);
        // A newer revision takes over; the rest of the older one is stale.
        let mut wire = Wire::new();
        wire.piece(5, &old, 0, 4);
        wire.piece(6, &new, 1, 4);
        wire.piece(5, &old, 1, 4);
        assert_eq!(wire.take(), None);
        wire.whole(6, &new, 4);
        assert_eq!(wire.take(), Some((Revision(6), new)));
        // The same number with other values, from before a restart of comms.
        let mut wire = Wire::new();
        wire.piece(5, &old, 0, 4);
        let mut index = 1;
        while wire.piece(5, &new, index, 4) {
            index += 1;
        }
        assert_eq!(wire.take(), None);
        wire.piece(5, &new, 0, 4);
        assert_eq!(wire.take(), Some((Revision(5), new)));
    }

    #[test]
    fn a_commit_with_a_wrong_checksum_is_not_applied_and_may_come_again() {
        let mut wire = Wire::new();
        let values = Values::default();
        for index in 0.. {
            let Some(piece) = Piece::of(&values.0, index) else {
                break;
            };
            let sum = checksum(&values.0) ^ 1;
            let (revision, active) = (Revision(5), Revision(4));
            wire.commits
                .receive(revision, (sum, ALL), &piece, active, &wire.counters);
        }
        assert_eq!(wire.take(), None);
        assert_eq!(wire.counters.get(DriveCounter::Discarded), 1);
        wire.whole(5, &values, 4);
        assert_eq!(wire.take(), Some((Revision(5), values)));
    }
}

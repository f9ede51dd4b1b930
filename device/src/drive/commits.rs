//! Assembly of commits that the link receives, for the idle loop.

use crate::counters::Counters;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::pieces::{Piece, Reassembly};
use crepitus_protocol::{Revision, ValueError, Values};

/// Received commits and their outcomes, of this boot of comms: after each boot it counts revisions from
/// the saved one again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commits {
    /// Boot counter of comms.
    comms_start: u16,
    /// The latest commit, until its preparation begins, and its pieces.
    pending: Option<Revision>,
    reassembly: Reassembly,
    /// The latest one that was whole, and so prepared or rejected. What is not whole may be of
    /// another boot.
    latest: Option<Revision>,
    /// The last rejected revision, and the reason.
    refused: Option<(Revision, ValueError)>,
}

/// A commit that was taken: its revision, and the boot of comms that has sent it.
pub type Taken = (Revision, u16);

impl Commits {
    /// Handles a piece of a commit. Returns whether its outcome is decided already, so that
    /// comms should hear of it.
    pub fn receive(
        &mut self,
        revision: Revision,
        (seal, pieces): (u32, u8),
        piece: &Piece,
        counters: &Counters,
    ) -> bool {
        let is_stale = |latest| revision.is_before(latest);
        // A later commit has overtaken it. NONE is no valid revision.
        if revision == Revision::NONE || self.latest.is_some_and(is_stale) {
            counters.count(DriveCounter::StaleCommands);
            return true;
        }
        // Comms repeats a commit until its outcome is confirmed.
        if self.latest == Some(revision) {
            return true;
        }
        if self.pending != Some(revision) || self.reassembly.seal() != seal {
            self.pending = Some(revision);
            self.reassembly.restart(seal, self.comms_start, pieces);
        }
        self.reassembly.add(piece);
        false
    }

    /// Takes the pending commit once complete, and copies it to `gathered`; see
    /// [`Self::verified`]. In one copy: the link waits meanwhile.
    pub fn take_into(&mut self, gathered: &mut Reassembly) -> Option<Taken> {
        let complete = self.pending.take_if(|_| self.reassembly.is_complete())?;
        *gathered = self.reassembly;
        Some((complete, self.comms_start))
    }

    /// Returns the values of a commit if its seal is valid; comms repeats an
    /// invalid one. The seal takes long, so call this outside a lock.
    pub fn verified(reassembly: &Reassembly, counters: &Counters) -> Option<Values> {
        let values = reassembly.values().map(Values);
        if values.is_none() {
            counters.count(DriveCounter::Discarded);
        }
        values
    }

    /// Records that a commit was prepared, and will take effect, or rejected. One of an earlier boot
    /// of comms is not recorded: its revision means nothing to this boot.
    pub fn done(
        &mut self,
        (revision, comms_start): Taken,
        result: Result<(), ValueError>,
        counters: &Counters,
    ) {
        if comms_start != self.comms_start {
            return;
        }
        // What has arrived meanwhile and is no newer: repeated, or late.
        self.pending
            .take_if(|pending| !revision.is_before(*pending));
        self.latest = Some(revision);
        if let Err(error) = result {
            counters.count(DriveCounter::RefusedCommits);
            self.refused = Some((revision, error));
        } else {
            self.refused = None;
        }
    }

    /// The last rejected revision, and the reason.
    pub fn refused(&self) -> Option<(Revision, ValueError)> {
        self.refused
    }

    /// Comms has started. A commit of before that was prepared still takes effect.
    pub fn restart(&mut self, comms_start: u16) {
        if comms_start != self.comms_start {
            self.comms_start = comms_start;
            (self.pending, self.latest, self.refused) = (None, None, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::parameters::{PARAMETER_COUNT, id};
    use crepitus_protocol::pieces::{PIECE_VALUES, seal};

    /// Every piece is sent, also those at their defaults.
    #[expect(clippy::cast_possible_truncation, reason = "less than 32")]
    const ALL: u8 = PARAMETER_COUNT.div_ceil(PIECE_VALUES) as u8;

    /// A link on which this boot of comms sends commits.
    struct Wire {
        counters: Counters,
        commits: Commits,
        start: u16,
    }

    impl Wire {
        fn new() -> Self {
            Self {
                counters: Counters::new(),
                commits: Commits::default(),
                start: 0,
            }
        }

        fn piece(&mut self, revision: u32, values: &Values, index: u8) -> bool {
            let piece = Piece::of(&values.0, index);
            if let Some(piece) = &piece {
                let seal = seal(&values.0, self.start);
                let revision = Revision(revision);
                self.commits
                    .receive(revision, (seal, ALL), piece, &self.counters);
            }
            piece.is_some()
        }

        fn whole(&mut self, revision: u32, values: &Values) {
            let mut index = 0;
            while self.piece(revision, values, index) {
                index += 1;
            }
            assert!(index > 1, "several pieces");
        }

        fn done(&mut self, revision: u32, result: Result<(), ValueError>) {
            let taken = (Revision(revision), self.start);
            self.commits.done(taken, result, &self.counters);
        }

        fn take(&mut self) -> Option<(Revision, Values)> {
            let mut gathered = Reassembly::default();
            let (revision, _) = self.commits.take_into(&mut gathered)?;
            Some((revision, Commits::verified(&gathered, &self.counters)?))
        }
    }

    #[test]
    fn revision_none_is_rejected() {
        let mut wire = Wire::new();
        wire.piece(Revision::NONE.0, &Values::default(), 0);
        assert_eq!(wire.commits.pending, None);
        assert_eq!(wire.counters.get(DriveCounter::StaleCommands), 1);
    }

    #[test]
    fn a_commit_is_taken_once_however_often_it_is_received() {
        let mut wire = Wire::new();
        let values = Values::default();
        for _ in 0..3 {
            wire.whole(5, &values);
        }
        assert_eq!(wire.take(), Some((Revision(5), values)));
        wire.done(5, Ok(()));
        wire.whole(5, &values);
        assert_eq!(wire.take(), None);
        // One that was overtaken does not come back.
        wire.whole(4, &values);
        assert_eq!(wire.take(), None);
        assert!(wire.counters.get(DriveCounter::StaleCommands) > 0);
        // A rejected revision stays rejected until comms restarts.
        let why = ValueError::NeedsDisarmed { id: 6 };
        wire.done(6, Err(why));
        wire.whole(6, &values);
        assert_eq!(wire.take(), None);
        assert_eq!(wire.commits.refused(), Some((Revision(6), why)));
        wire.commits.restart(1);
        wire.start = 1;
        wire.whole(2, &values);
        assert!(wire.take().is_some());
    }

    #[test]
    fn pieces_of_two_commits_are_never_one() {
        let (old, mut new) = (Values::default(), Values::default());
        new.set(id::STATIC_TORQUE, 0.5);
        new.set(id::TORQUE_LIMIT, 3.0);
        let mut wire = Wire::new();
        wire.piece(5, &old, 0);
        wire.piece(6, &new, 1);
        wire.piece(5, &old, 1);
        assert_eq!(wire.take(), None);
        wire.whole(6, &new);
        assert_eq!(wire.take(), Some((Revision(6), new)));
        wire.done(6, Ok(()));
        // A newer revision has taken over; the rest of the older one is stale.
        wire.whole(5, &old);
        assert_eq!(wire.take(), None);
        // A commit of the same number with other values, from before a restart of comms.
        let mut wire = Wire::new();
        wire.piece(5, &old, 0);
        let mut index = 1;
        while wire.piece(5, &new, index) {
            index += 1;
        }
        assert_eq!(wire.take(), None);
        wire.piece(5, &new, 0);
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
            let seal = seal(&values.0, 0) ^ 1;
            wire.commits
                .receive(Revision(5), (seal, ALL), &piece, &wire.counters);
        }
        assert_eq!(wire.take(), None);
        assert_eq!(wire.counters.get(DriveCounter::Discarded), 1);
        wire.whole(5, &values);
        assert_eq!(wire.take(), Some((Revision(5), values)));
    }

    #[test]
    fn an_older_commit_that_arrives_while_one_is_prepared_is_too_late() {
        let values = Values::default();
        let mut wire = Wire::new();
        wire.whole(9, &values);
        assert_eq!(wire.take(), Some((Revision(9), values)));
        wire.whole(8, &values);
        wire.done(9, Ok(()));
        assert_eq!(wire.take(), None);
        wire.whole(10, &values);
        assert_eq!(wire.take(), Some((Revision(10), values)));
    }

    /// After a restart comms counts revisions from the saved one again: two commits may have one number.
    #[test]
    fn what_is_of_another_start_of_comms_is_not_taken() {
        let (old, mut new) = (Values::default(), Values::default());
        new.set(id::STATIC_TORQUE, 0.5);
        let mut wire = Wire::new();
        (wire.start, wire.commits.comms_start) = (7, 7);
        wire.whole(8, &old);
        assert!(wire.take().is_some());
        wire.commits.restart(8);
        // Prepared while comms started.
        wire.done(8, Ok(()));
        // Late, or once more.
        wire.whole(8, &old);
        assert_eq!(wire.take(), None);
        wire.start = 8;
        // An older number is none to the new start.
        wire.whole(7, &old);
        assert_eq!(wire.take(), Some((Revision(7), old)));
        wire.done(7, Ok(()));
        wire.whole(8, &new);
        assert_eq!(wire.take(), Some((Revision(8), new)));
    }
}

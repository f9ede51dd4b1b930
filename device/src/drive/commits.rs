//! Commits on their way from the link to the idle loop.

use crate::counters::Counters;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::{Revision, ValueError, Values};

/// What was heard of commits, and what became of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commits {
    /// The latest that waits for its preparation.
    wanted: Option<(Revision, Values)>,
    /// The newest that was heard of this start of comms.
    newest: Option<Revision>,
    /// The one that was prepared last; it comes into force with a block.
    prepared: Option<Revision>,
    /// The last one that was refused, and why.
    refused: Option<(Revision, ValueError)>,
}

impl Commits {
    /// A commit was heard while `in_force` is.
    pub fn hear(
        &mut self,
        revision: Revision,
        values: &Values,
        in_force: Revision,
        counters: &Counters,
    ) {
        let is_older = |newest: Revision| revision.0.wrapping_sub(newest.0).cast_signed() < 0;
        // Overtaken on its way by the one after it; or the number of none, which
        // no commit has.
        if revision == Revision::NONE || self.newest.is_some_and(is_older) {
            counters.count(DriveCounter::StaleCommands);
            return;
        }
        self.newest = Some(revision);
        // Comms repeats it until it has heard what became of it.
        let is_known = in_force == revision
            || self.prepared == Some(revision)
            || self.wanted.is_some_and(|(wanted, _)| wanted == revision)
            || self.refused.is_some_and(|(refused, _)| refused == revision);
        if !is_known {
            self.wanted = Some((revision, *values));
        }
    }

    /// The one that waits, if there is one.
    pub fn take(&mut self) -> Option<(Revision, Values)> {
        self.wanted.take()
    }

    /// It was prepared, and will come into force; or refused.
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

    /// The last one that was refused, and why.
    pub fn refused(&self) -> Option<(Revision, ValueError)> {
        self.refused
    }

    /// Comms has started anew: its numbers begin anew, too. What was prepared
    /// comes into force all the same.
    pub fn forget(&mut self) {
        (self.wanted, self.newest, self.refused) = (None, None, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_none_is_no_commit() {
        let counters = Counters::new();
        let mut commits = Commits::default();
        commits.hear(Revision::NONE, &Values::default(), Revision(4), &counters);
        assert_eq!(commits.take(), None);
        assert_eq!(counters.get(DriveCounter::StaleCommands), 1);
    }

    #[test]
    fn a_commit_is_taken_once_however_often_it_is_heard() {
        let counters = Counters::new();
        let mut commits = Commits::default();
        let values = Values::default();
        for _ in 0..3 {
            commits.hear(Revision(5), &values, Revision(4), &counters);
        }
        assert_eq!(commits.take(), Some((Revision(5), values)));
        commits.done(Revision(5), Ok(()), &counters);
        commits.hear(Revision(5), &values, Revision(4), &counters);
        assert_eq!(commits.take(), None);
        // One that was overtaken does not come back.
        commits.hear(Revision(4), &values, Revision(5), &counters);
        assert_eq!(commits.take(), None);
        assert_eq!(counters.get(DriveCounter::StaleCommands), 1);
        // What was refused stays refused, until comms starts anew.
        let why = ValueError::NeedsDisarmed { id: 6 };
        commits.done(Revision(6), Err(why), &counters);
        commits.hear(Revision(6), &values, Revision(5), &counters);
        assert_eq!(commits.take(), None);
        assert_eq!(commits.refused(), Some((Revision(6), why)));
        commits.forget();
        commits.hear(Revision(2), &values, Revision(5), &counters);
        assert!(commits.take().is_some());
    }
}

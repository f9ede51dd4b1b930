//! Oracle of the lease: whether torque may be on, at most, from what hosts have
//! sent. Its clock is the caller's.

use crepitus_protocol::Session;
use std::collections::BTreeMap;

/// Request to arm by which a session may hold the lease.
struct Armed {
    /// The number of its request to arm.
    number: u32,
    /// Time at which that request was executed, or the lease was renewed last.
    at: u64,
}

/// The lease, as far as hosts can have it.
pub(crate) struct LeaseOracle {
    length: u64,
    /// Sessions that may hold it: each has requested arming, and since then nobody has disarmed.
    armers: BTreeMap<u32, Armed>,
    /// Last time at which a session that was one of `armers` had armed or renewed.
    before: Option<u64>,
}

impl LeaseOracle {
    /// Oracle of a lease that nobody holds. `length` is that of a lease.
    pub(crate) fn new(length: u64) -> Self {
        Self {
            length,
            armers: BTreeMap::new(),
            before: None,
        }
    }

    /// A request to arm was executed; it may have been refused.
    pub(crate) fn arm(&mut self, session: Session, number: u32, now: u64) {
        if !self.is_alive(now) {
            self.stop();
        }
        self.armers.insert(session.0, Armed { number, at: now });
    }

    /// That request was refused, since another session holds the lease.
    pub(crate) fn refused(&mut self, session: Session, number: u32) {
        if self
            .armers
            .get(&session.0)
            .is_some_and(|armed| armed.number == number)
        {
            self.armers.remove(&session.0);
        }
    }

    /// A renewal was received; returns whether it may count.
    pub(crate) fn renew(&mut self, session: Session, now: u64) -> bool {
        let length = self.length;
        let armed = self.armers.get_mut(&session.0);
        let alive = armed.filter(|armed| now - armed.at < length);
        let may_count = alive.is_some();
        if let Some(armed) = alive {
            armed.at = now;
        }
        may_count
    }

    /// A request to disarm was executed: refused while another session holds
    /// the lease.
    pub(crate) fn disarm(&mut self, session: Session) {
        if self.armers.keys().all(|armer| *armer == session.0) {
            self.stop();
        }
    }

    /// Records that nobody holds it any more.
    pub(crate) fn stop(&mut self) {
        self.before = self.last();
        self.armers.clear();
    }

    /// The last time at which somebody who may have held it has armed, or has renewed it.
    pub(crate) fn last(&self) -> Option<u64> {
        self.armers
            .values()
            .map(|armed| armed.at)
            .max()
            .max(self.before)
    }

    /// Returns whether somebody may hold it.
    pub(crate) fn is_alive(&self, now: u64) -> bool {
        self.armers
            .values()
            .any(|armed| now - armed.at < self.length)
    }

    /// Returns whether a host has requested arming, and since then nobody has disarmed.
    pub(crate) fn is_wanted(&self) -> bool {
        !self.armers.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Session = Session(1);
    const B: Session = Session(2);

    #[test]
    fn a_request_that_was_refused_neither_renews_nor_holds() {
        let mut lease = LeaseOracle::new(100);
        lease.arm(A, 1, 0);
        lease.arm(B, 7, 50);
        lease.refused(B, 7);
        assert_eq!(lease.last(), Some(0));
        assert!(!lease.renew(B, 60) && !lease.is_alive(100));
        lease.disarm(A);
        assert!(!lease.is_wanted());
    }

    #[test]
    fn a_lease_that_has_ended_is_not_renewed() {
        let mut lease = LeaseOracle::new(100);
        lease.arm(A, 1, 0);
        assert!(lease.renew(A, 99) && !lease.renew(A, 199));
        assert_eq!(lease.last(), Some(99));
    }
}

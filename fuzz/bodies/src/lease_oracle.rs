//! Oracle of the lease: whether torque may be on, at most, from what hosts have
//! sent. Its clock is the caller's.

use crepitus_protocol::Session;
use std::collections::BTreeSet;

/// The lease, as far as hosts can have it.
pub(crate) struct LeaseOracle {
    length: u64,
    /// When it was acquired or renewed last.
    renewed: Option<u64>,
    /// A host has requested arming, and since then nobody has disarmed.
    is_wanted: bool,
    /// Sessions that may hold it.
    armers: BTreeSet<u32>,
}

impl LeaseOracle {
    /// Nobody holds it. `length` is that of a lease.
    pub(crate) fn new(length: u64) -> Self {
        Self {
            length,
            renewed: None,
            is_wanted: false,
            armers: BTreeSet::new(),
        }
    }

    /// A request to arm was executed; it may have been refused.
    pub(crate) fn arm(&mut self, session: Session, now: u64) {
        if !self.is_alive(now) {
            self.armers.clear();
        }
        (self.is_wanted, self.renewed) = (true, Some(now));
        self.armers.insert(session.0);
    }

    /// A renewal was received; returns whether it may count.
    pub(crate) fn renew(&mut self, session: Session, now: u64) -> bool {
        let may_count = self.is_alive(now) && self.armers.contains(&session.0);
        if may_count {
            self.renewed = Some(now);
        }
        may_count
    }

    /// A request to disarm was executed: refused while another session holds
    /// the lease.
    pub(crate) fn disarm(&mut self, session: Session) {
        if self.armers.iter().all(|armer| *armer == session.0) {
            self.stop();
        }
    }

    /// Nobody holds it any more.
    pub(crate) fn stop(&mut self) {
        (self.is_wanted, self.renewed) = (false, None);
        self.armers.clear();
    }

    /// Whether somebody may hold it.
    pub(crate) fn is_alive(&self, now: u64) -> bool {
        self.renewed
            .is_some_and(|renewed| now - renewed < self.length)
    }

    /// Whether a host has requested arming, and since then nobody has disarmed.
    pub(crate) fn is_wanted(&self) -> bool {
        self.is_wanted
    }
}

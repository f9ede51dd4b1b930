//! The lease: which host may have torque on, and until when.
//!
//! A host that arms acquires the lease and has to renew it. The lease expires
//! 250 ms after the last renewal, by the clock of comms and, independently of
//! it, at a tick of the drive's own clock.

use crepitus_protocol::{LEASE_TICKS, Session};

/// Length of a lease by the clock of comms, ms.
pub const LEASE_MS: u64 = 250;

/// The lease.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lease {
    holder: Option<Holder>,
}

#[derive(Clone, Copy, Debug)]
struct Holder {
    session: Session,
    /// Expiry by the clock of comms, ms.
    end_ms: u64,
    /// Expiry by the clock of the drive, ticks.
    end_tick: u64,
    /// The expiry was reported.
    expiry_reported: bool,
}

impl Lease {
    /// The session that holds the lease, unless it has expired.
    pub fn holder(&self, now_ms: u64) -> Option<Session> {
        self.holder
            .filter(|holder| now_ms < holder.end_ms)
            .map(|holder| holder.session)
    }

    /// Returns whether a host holds the lease.
    pub fn is_alive(&self, now_ms: u64) -> bool {
        self.holder(now_ms).is_some()
    }

    /// The holder, if that is not `session`.
    pub fn other_holder(&self, session: Session, now_ms: u64) -> Option<Session> {
        self.holder(now_ms).filter(|holder| *holder != session)
    }

    /// Gives the lease to this session. The caller checks for another holder.
    pub fn acquire(&mut self, session: Session, now_ms: u64, seen_tick: u64) {
        self.holder = Some(Holder {
            session,
            end_ms: now_ms.saturating_add(LEASE_MS),
            end_tick: seen_tick.saturating_add(LEASE_TICKS).saturating_sub(1),
            expiry_reported: false,
        });
    }

    /// Renews the lease if this session holds it; an expired lease cannot be
    /// renewed.
    pub fn renew(&mut self, session: Session, now_ms: u64, seen_tick: u64) -> bool {
        let is_holder = self.holder(now_ms) == Some(session);
        if is_holder {
            self.acquire(session, now_ms, seen_tick);
        }
        is_holder
    }

    /// Releases the lease.
    pub fn release(&mut self) {
        self.holder = None;
    }

    /// Reports an expiry once.
    pub fn take_expiry(&mut self, now_ms: u64) -> bool {
        match &mut self.holder {
            Some(holder) if !holder.expiry_reported && now_ms >= holder.end_ms => {
                holder.expiry_reported = true;
                true
            }
            _ => false,
        }
    }

    /// Ticks from `seen_tick` to the expiry.
    pub fn remaining_ticks(&self, seen_tick: u64, now_ms: u64) -> u16 {
        let left = self
            .holder
            .filter(|holder| now_ms < holder.end_ms)
            .map_or(0, |holder| holder.end_tick.saturating_sub(seen_tick));
        // At most a whole lease, in case the drive's ticks restart at 0.
        u16::try_from(left.min(LEASE_TICKS.saturating_sub(1))).unwrap_or(u16::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Session = Session(1);
    const B: Session = Session(2);

    #[test]
    fn it_expires_unless_renewed() {
        let mut lease = Lease::default();
        assert!(!lease.renew(A, 0, 0), "nobody's lease is not renewed");
        lease.acquire(A, 100, 2_000);
        assert_eq!(lease.remaining_ticks(2_000, 100), 5_000);
        assert_eq!(lease.remaining_ticks(2_400, 120), 4_600);
        assert_eq!(
            lease.remaining_ticks(20, 120),
            5_000,
            "a drive that was reset"
        );
        assert!(lease.is_alive(349) && !lease.is_alive(350));
        assert!(!lease.renew(B, 200, 4_000));
        assert!(lease.renew(A, 300, 6_000));
        assert!(lease.is_alive(549));
        assert_eq!(lease.other_holder(B, 400), Some(A));
        assert_eq!(lease.other_holder(A, 400), None);
        assert!(!lease.take_expiry(549));
        assert!(lease.take_expiry(550));
        assert!(!lease.take_expiry(551));
        assert_eq!(lease.remaining_ticks(6_000, 550), 0);
        assert!(!lease.renew(A, 550, 11_000), "it does not come back");
        lease.acquire(B, 600, 12_000);
        assert_eq!(lease.holder(600), Some(B));
        lease.release();
        assert!(!lease.is_alive(600));
    }
}

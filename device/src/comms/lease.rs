//! Who may have torque rendered, and for how long.
//!
//! A host that arms takes the lease and has to renew it. The lease ends 250 ms
//! after the last renewal, by the clock of comms and, independently of it, at a
//! tick of the drive's own clock.

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
    /// When it ends by the clock of comms, ms.
    end_ms: u64,
    /// When it ends by the clock of the drive.
    end_tick: u64,
    /// Its end was noticed.
    ended: bool,
}

impl Lease {
    /// Who has it, if it is alive.
    pub fn holder(&self, now_ms: u64) -> Option<Session> {
        self.holder
            .filter(|holder| now_ms < holder.end_ms)
            .map(|holder| holder.session)
    }

    /// Whether somebody has it.
    pub fn is_alive(&self, now_ms: u64) -> bool {
        self.holder(now_ms).is_some()
    }

    /// The other host that has it.
    pub fn other_than(&self, session: Session, now_ms: u64) -> Option<Session> {
        self.holder(now_ms).filter(|holder| *holder != session)
    }

    /// Takes it. Somebody else's must have been asked for before.
    pub fn take(&mut self, session: Session, now_ms: u64, seen_tick: u64) {
        self.holder = Some(Holder {
            session,
            end_ms: now_ms.saturating_add(LEASE_MS),
            end_tick: seen_tick.saturating_add(LEASE_TICKS).saturating_sub(1),
            ended: false,
        });
    }

    /// Renews it, if this host has it and it is still alive: one that has
    /// ended does not come back.
    pub fn renew(&mut self, session: Session, now_ms: u64, seen_tick: u64) -> bool {
        let has_it = self.holder(now_ms) == Some(session);
        if has_it {
            self.take(session, now_ms, seen_tick);
        }
        has_it
    }

    /// Gives it back.
    pub fn release(&mut self) {
        self.holder = None;
    }

    /// Whether it has ended since this was asked last.
    pub fn has_just_ended(&mut self, now_ms: u64) -> bool {
        match &mut self.holder {
            Some(holder) if !holder.ended && now_ms >= holder.end_ms => {
                holder.ended = true;
                true
            }
            _ => false,
        }
    }

    /// How many ticks after `seen_tick` it ends.
    pub fn left_ticks(&self, seen_tick: u64, now_ms: u64) -> u16 {
        let left = self
            .holder
            .filter(|holder| now_ms < holder.end_ms)
            .map_or(0, |holder| holder.end_tick.saturating_sub(seen_tick));
        // No longer than a whole one, should the drive's ticks begin anew.
        u16::try_from(left.min(LEASE_TICKS.saturating_sub(1))).unwrap_or(u16::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Session = Session(1);
    const B: Session = Session(2);

    #[test]
    fn it_lives_as_long_as_it_is_renewed() {
        let mut lease = Lease::default();
        assert!(!lease.renew(A, 0, 0), "nobody's lease is not renewed");
        lease.take(A, 100, 2_000);
        assert_eq!(lease.left_ticks(2_000, 100), 5_000);
        assert_eq!(lease.left_ticks(2_400, 120), 4_600);
        assert_eq!(lease.left_ticks(20, 120), 5_000, "a drive that was reset");
        assert!(lease.is_alive(349) && !lease.is_alive(350));
        assert!(!lease.renew(B, 200, 4_000));
        assert!(lease.renew(A, 300, 6_000));
        assert!(lease.is_alive(549));
        assert_eq!(lease.other_than(B, 400), Some(A));
        assert_eq!(lease.other_than(A, 400), None);
        assert!(!lease.has_just_ended(549));
        assert!(lease.has_just_ended(550));
        assert!(!lease.has_just_ended(551));
        assert_eq!(lease.left_ticks(6_000, 550), 0);
        assert!(!lease.renew(A, 550, 11_000), "it does not come back");
        lease.take(B, 600, 12_000);
        assert_eq!(lease.holder(600), Some(B));
        lease.release();
        assert!(!lease.is_alive(600));
    }
}

//! Whether comms, and behind it a host, is still there.
//!
//! Both ends are ticks of the drive's own clock, which comms echoes: a
//! heartbeat that was delayed, repeated or replayed makes neither later.

use crepitus_protocol::link::{Heartbeat, STALE_TICKS};
use crepitus_protocol::{Fault, HEARTBEAT_TICKS};

/// What became of a heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// It counts.
    Fresh,
    /// It had been on its way for too long.
    Stale,
    /// It is of another start of comms than those before.
    Restarted,
}

/// Watches over heartbeats and lease.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vigil {
    /// The tick in which the last fresh heartbeat came.
    heard: Option<u64>,
    /// The tick in which the lease ends.
    lease_end: u64,
    /// Which start of comms.
    start: Option<u16>,
}

/// Whether what echoes `seen_tick` is fresh at `now`.
pub fn is_fresh(now: u64, seen_tick: u64) -> bool {
    // A tick that is yet to come was seen before a restart of the drive.
    now.checked_sub(seen_tick)
        .is_some_and(|age| age <= STALE_TICKS)
}

impl Vigil {
    /// Takes a heartbeat that was decoded in the tick `now`.
    pub fn hear(&mut self, now: u64, heartbeat: &Heartbeat) -> Heard {
        if !is_fresh(now, heartbeat.seen_tick) {
            return Heard::Stale;
        }
        let restarted = self.start.is_some_and(|start| start != heartbeat.start);
        self.start = Some(heartbeat.start);
        self.heard = Some(now);
        self.lease_end = heartbeat
            .seen_tick
            .saturating_add(u64::from(heartbeat.lease_left));
        if restarted {
            Heard::Restarted
        } else {
            Heard::Fresh
        }
    }

    /// Which start of comms was heard last.
    pub fn start(&self) -> Option<u16> {
        self.start
    }

    /// Whether the lease is alive.
    pub fn is_leased(&self, now: u64) -> bool {
        self.heard.is_some() && now < self.lease_end
    }

    /// What is missing in the tick `now`.
    pub fn missing(&self, now: u64) -> Option<Fault> {
        let silent = self
            .heard
            // The torque of this tick is that of the next half: one tick less.
            .is_none_or(|heard| now.saturating_sub(heard) >= HEARTBEAT_TICKS - 1);
        if silent {
            Some(Fault::CommsSilent)
        } else if self.is_leased(now) {
            None
        } else {
            Some(Fault::LeaseExpired)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heartbeat(seen_tick: u64, lease_left: u16) -> Heartbeat {
        Heartbeat {
            seen_tick,
            lease_left,
            enable: true,
            start: 1,
        }
    }

    #[test]
    fn silence_is_noticed_before_its_time_is_over() {
        for start in [1_000, u64::MAX - 10_000] {
            let mut vigil = Vigil::default();
            assert_eq!(vigil.missing(start), Some(Fault::CommsSilent));
            assert_eq!(
                vigil.hear(start, &heartbeat(start - 60, 5_000)),
                Heard::Fresh
            );
            assert_eq!(vigil.missing(start + 99), None);
            assert_eq!(vigil.missing(start + 100), Some(Fault::CommsSilent));
        }
    }

    #[test]
    fn a_lease_ends_at_its_tick_however_late_it_is_heard_of() {
        let mut vigil = Vigil::default();
        for (now, late) in [(10_000, 0), (10_000, 300), (10_000, 400)] {
            vigil.hear(now, &heartbeat(now - late, 500));
            assert!(vigil.is_leased(now - late + 499));
            assert!(!vigil.is_leased(now - late + 500));
        }
        vigil.hear(20_000, &heartbeat(20_000, 0));
        assert_eq!(vigil.missing(20_000), Some(Fault::LeaseExpired));
    }

    #[test]
    fn what_is_old_or_from_the_future_does_not_count() {
        let mut vigil = Vigil::default();
        assert_eq!(vigil.hear(10_000, &heartbeat(9_599, 5_000)), Heard::Stale);
        assert_eq!(vigil.hear(10_000, &heartbeat(10_001, 5_000)), Heard::Stale);
        assert!(!vigil.is_leased(10_000));
    }

    #[test]
    fn another_start_of_comms_is_noticed_once() {
        let mut vigil = Vigil::default();
        vigil.hear(100, &heartbeat(100, 5_000));
        let other = Heartbeat {
            start: 2,
            ..heartbeat(110, 5_000)
        };
        assert_eq!(vigil.hear(110, &other), Heard::Restarted);
        assert_eq!(vigil.hear(120, &other), Heard::Fresh);
    }
}

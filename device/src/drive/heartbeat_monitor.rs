//! Timeout supervision of heartbeats and of the host's lease.
//!
//! Both deadlines are ticks of the drive's own clock, which comms echoes: a
//! heartbeat that is delayed, repeated or replayed extends the lease by nothing. One that
//! is repeated does not postpone the timeout, as its number is not a new one; one that is
//! delayed does while its echo is fresh, [`STALE_TICKS`]. After the timeout any other number
//! is a new one.

use crepitus_protocol::link::{Heartbeat, STALE_TICKS};
use crepitus_protocol::{Fault, HEARTBEAT_TICKS};

/// Freshness of a heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freshness {
    /// Fresh: it resets the timeout.
    Fresh,
    /// Stale: it was delayed too long and is ignored.
    Stale,
    /// Fresh, and the first one of this start of comms.
    Started,
}

/// Monitors heartbeats and lease.
#[derive(Clone, Copy, Debug, Default)]
pub struct HeartbeatMonitor {
    /// Tick of the last fresh heartbeat.
    last_tick: Option<u64>,
    /// Tick at which the lease expires.
    lease_end: u64,
    /// Boot counter of comms.
    comms_start: Option<u16>,
    /// Number of the last fresh heartbeat.
    number: u8,
}

/// Heartbeats that may be lost in a row: those of more than the timeout.
const MOST_AHEAD: u8 = 127;

/// Returns whether a message that echoes `seen_tick` is fresh at `now`.
pub fn is_fresh(now: u64, seen_tick: u64) -> bool {
    // A tick in the future is from before a restart of the drive.
    now.checked_sub(seen_tick)
        .is_some_and(|age| age <= STALE_TICKS)
}

impl HeartbeatMonitor {
    /// Handles a heartbeat that was decoded in the tick `now`.
    pub fn receive(&mut self, now: u64, heartbeat: &Heartbeat) -> Freshness {
        if !is_fresh(now, heartbeat.seen_tick) {
            return Freshness::Stale;
        }
        let has_started = self.comms_start != Some(heartbeat.start);
        let ahead = heartbeat.number.wrapping_sub(self.number);
        let is_new =
            has_started || (1..=MOST_AHEAD).contains(&ahead) || ahead != 0 && self.was_silent(now);
        if !is_new {
            return Freshness::Stale;
        }
        self.number = heartbeat.number;
        self.comms_start = Some(heartbeat.start);
        self.last_tick = Some(now);
        self.lease_end = heartbeat
            .seen_tick
            .saturating_add(u64::from(heartbeat.lease_left));
        if has_started {
            Freshness::Started
        } else {
            Freshness::Fresh
        }
    }

    /// Boot counter of comms, from the last heartbeat.
    pub fn comms_start(&self) -> Option<u16> {
        self.comms_start
    }

    /// Returns whether the lease has not expired.
    pub fn is_leased(&self, now: u64) -> bool {
        self.last_tick.is_some() && now < self.lease_end
    }

    /// Returns whether the timeout expired in an earlier tick.
    fn was_silent(&self, now: u64) -> bool {
        self.is_silent(now.saturating_sub(1))
    }

    fn is_silent(&self, now: u64) -> bool {
        self.last_tick
            // The output of this tick acts during the next: one tick less.
            .is_none_or(|last_tick| now.saturating_sub(last_tick) >= HEARTBEAT_TICKS - 1)
    }

    /// The fault of an expired timeout in the tick `now`.
    pub fn timeout(&self, now: u64) -> Option<Fault> {
        if self.is_silent(now) {
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

    /// The number grows with the tick.
    fn heartbeat(seen_tick: u64, lease_left: u16) -> Heartbeat {
        Heartbeat {
            seen_tick,
            lease_left,
            enable: true,
            start: 1,
            number: (seen_tick % 256) as u8,
        }
    }

    #[test]
    fn a_heartbeat_timeout_is_detected_in_time() {
        for start in [1_000, u64::MAX - 10_000] {
            let mut monitor = HeartbeatMonitor::default();
            assert_eq!(monitor.timeout(start), Some(Fault::CommsSilent));
            assert_eq!(
                monitor.receive(start, &heartbeat(start - 60, 5_000)),
                Freshness::Started
            );
            assert_eq!(monitor.timeout(start + 92), None);
            assert_eq!(monitor.timeout(start + 93), Some(Fault::CommsSilent));
        }
    }

    #[test]
    fn a_lease_ends_at_its_tick_whatever_the_latency() {
        let mut monitor = HeartbeatMonitor::default();
        for (now, late) in [(10_000, 0), (10_310, 300), (10_420, 400)] {
            assert_ne!(
                monitor.receive(now, &heartbeat(now - late, 500)),
                Freshness::Stale
            );
            assert!(monitor.is_leased(now - late + 499));
            assert!(!monitor.is_leased(now - late + 500));
        }
        monitor.receive(20_080, &heartbeat(20_080, 0));
        assert_eq!(monitor.timeout(20_080), Some(Fault::LeaseExpired));
    }

    #[test]
    fn stale_and_future_heartbeats_are_ignored() {
        let mut monitor = HeartbeatMonitor::default();
        assert_eq!(
            monitor.receive(10_000, &heartbeat(9_599, 5_000)),
            Freshness::Stale
        );
        assert_eq!(
            monitor.receive(10_000, &heartbeat(10_001, 5_000)),
            Freshness::Stale
        );
        assert!(!monitor.is_leased(10_000));
    }

    #[test]
    fn a_restart_of_comms_is_reported_once() {
        let mut monitor = HeartbeatMonitor::default();
        monitor.receive(100, &heartbeat(100, 5_000));
        let other = Heartbeat {
            start: 2,
            ..heartbeat(110, 5_000)
        };
        assert_eq!(monitor.receive(110, &other), Freshness::Started);
        assert_eq!(monitor.receive(120, &other), Freshness::Stale);
        let next = Heartbeat {
            number: other.number.wrapping_add(1),
            ..other
        };
        assert_eq!(monitor.receive(120, &next), Freshness::Fresh);
    }

    /// Bytes that come again, in any order, are no sign of life.
    #[test]
    fn what_was_received_before_postpones_nothing() {
        let mut monitor = HeartbeatMonitor::default();
        let sent = [10_000, 10_001, 10_002].map(|tick| heartbeat(tick, 5_000));
        for (n, heartbeat) in (0..).zip(&sent) {
            let is_new = [Freshness::Started, Freshness::Fresh][usize::from(n > 0)];
            assert_eq!(monitor.receive(10_010 + n, heartbeat), is_new);
        }
        let end = 10_012 + HEARTBEAT_TICKS - 1;
        for now in 10_013..end {
            for heartbeat in &sent {
                assert_eq!(monitor.receive(now, heartbeat), Freshness::Stale);
            }
            assert_eq!(monitor.timeout(now), None, "{now}");
        }
        // What is received in a tick comes before its timeout.
        for heartbeat in &sent {
            assert_eq!(monitor.receive(end, heartbeat), Freshness::Stale);
        }
        assert_eq!(monitor.timeout(end), Some(Fault::CommsSilent));
        assert_eq!(monitor.receive(end + 1, &sent[2]), Freshness::Stale);
        // As many may be lost as the timeout does not last.
        let ahead = |ahead| Heartbeat {
            number: sent[2].number.wrapping_add(ahead),
            ..heartbeat(10_100, 5_000)
        };
        assert_eq!(monitor.receive(10_101, &ahead(127)), Freshness::Fresh);
        assert_eq!(monitor.receive(10_102, &ahead(255)), Freshness::Stale);
        // And after it any other is a new one.
        assert_eq!(monitor.receive(10_300, &ahead(255)), Freshness::Fresh);
    }
}

//! Real time, as ticks of the device.

use crepitus_protocol::TICKS_PER_S;
use std::time::{Duration, Instant};

/// Longest lag of simulated time that is caught up. In a burst hardly any renewal arrives: with what
/// has passed since the last one it must stay below the lease of 250 ms, which a host that was never
/// late would lose otherwise.
const MOST_LAG: Duration = Duration::from_millis(100);

/// Longest absence of a program that simulated time follows; a lease has ended long before.
const MOST_AWAY: Duration = Duration::from_mins(1);

/// Clock that counts real time in ticks of the device.
pub struct Clock {
    begun: Instant,
    ticks: u64,
}

impl Clock {
    /// Starts the clock.
    #[expect(
        clippy::new_without_default,
        reason = "a clock that starts by default would hide when"
    )]
    pub fn new() -> Self {
        Self {
            begun: Instant::now(),
            ticks: 0,
        }
    }

    /// Returns the ticks since the last call, at most those of 100 ms.
    pub fn due_ticks(&mut self) -> u64 {
        self.ticks_within(MOST_LAG)
    }

    /// Returns the ticks since the last call, in which nobody was to renew anything: at most those of a minute.
    pub fn away_ticks(&mut self) -> u64 {
        self.ticks_within(MOST_AWAY)
    }

    fn ticks_within(&mut self, most: Duration) -> u64 {
        let per_tick = Duration::from_secs(1) / TICKS_PER_S;
        let elapsed = self.begun.elapsed().as_nanos();
        let now = u64::try_from(elapsed / per_tick.as_nanos()).unwrap_or(u64::MAX);
        let due = now.saturating_sub(self.ticks);
        self.ticks = now;
        // Time in which the computer slept is not caught up.
        let most = u64::try_from(most.as_nanos() / per_tick.as_nanos()).unwrap_or(u64::MAX);
        due.min(most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::RENEW_EVERY;
    use crepitus_protocol::LEASE_TICKS;

    #[test]
    fn catching_up_takes_no_lease_from_a_host_that_is_in_time() {
        let lease = Duration::from_secs(1) / TICKS_PER_S * u32::try_from(LEASE_TICKS).unwrap();
        assert!(MOST_LAG + 2 * RENEW_EVERY < lease);
    }

    #[test]
    fn of_an_absence_all_is_caught_up_but_for_what_is_beyond_a_minute() {
        for (away_s, ticks) in [(50, 1_000_000), (3_600, 1_200_000)] {
            let begun = Instant::now().checked_sub(Duration::from_secs(away_s));
            let Some(begun) = begun else { continue };
            let mut clock = Clock { begun, ticks: 0 };
            assert!((ticks..ticks + 20_000).contains(&clock.away_ticks()));
            assert!(clock.away_ticks() < 20_000);
        }
    }

    #[test]
    fn of_the_time_asleep_100_ms_are_caught_up_once() {
        let awake = Instant::now();
        let begun = awake.checked_sub(Duration::from_secs(50)).unwrap();
        let mut clock = Clock { begun, ticks: 0 };
        assert_eq!(clock.due_ticks(), 2_000);
        let next: u64 = (0..10).map(|_| clock.due_ticks()).sum();
        // However slow this computer is.
        let passed = awake.elapsed().as_micros() / 50 + 1;
        assert!(u128::from(next) <= passed, "{next} ticks, not {passed}");
    }
}

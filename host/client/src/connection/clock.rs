//! Real time, as ticks of the device.

use crepitus_protocol::TICKS_PER_S;
use std::time::{Duration, Instant};

/// Longest lag of simulated time that is caught up.
const MOST_LAG: Duration = Duration::from_millis(200);

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

    /// Returns the ticks since the last call, at most those of 200 ms.
    pub fn due_ticks(&mut self) -> u64 {
        let per_tick = Duration::from_secs(1) / TICKS_PER_S;
        let elapsed = self.begun.elapsed().as_nanos();
        let now = u64::try_from(elapsed / per_tick.as_nanos()).unwrap_or(u64::MAX);
        let due = now.saturating_sub(self.ticks);
        self.ticks = now;
        // Time in which the computer slept is not caught up.
        let most = u64::try_from(MOST_LAG.as_nanos() / per_tick.as_nanos()).unwrap_or(u64::MAX);
        due.min(most)
    }
}

//! The hand of the page in control on the leg of a simulated device: its requests, at a limited rate.

use crate::control::Page;
use crepitus_model::control::device_limits::RangeSettings;
use serde_json::{Value, json};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Least time between two requests that reach the leg: no display is faster. Of those between, the last one counts.
const LEAST_INTERVAL: Duration = Duration::from_millis(4);

/// Request of a page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HandRequest {
    pub(crate) page: Page,
    /// Angle of the knee, °, from the device's zero.
    pub(crate) angle_deg: f64,
    /// Whether the hand holds the leg; otherwise it lets go.
    pub(crate) holds: bool,
}

/// The newest request.
#[derive(Debug, Default)]
pub(crate) struct HandRequests(Mutex<Pending>);

#[derive(Debug, Default)]
struct Pending {
    newest: Option<HandRequest>,
    taken_at: Option<Instant>,
}

impl HandRequests {
    /// Replaces what was asked before.
    pub(crate) fn put(&self, request: HandRequest) {
        self.lock().newest = Some(request);
    }

    /// Takes the newest request, if there is one and the last one is long enough ago.
    pub(crate) fn take(&self, now: Instant) -> Option<HandRequest> {
        let mut pending = self.lock();
        let is_early = |at| now.saturating_duration_since(at) < LEAST_INTERVAL;
        if pending.taken_at.is_some_and(is_early) {
            return None;
        }
        let request = pending.newest.take()?;
        pending.taken_at = Some(now);
        Some(request)
    }

    fn lock(&self) -> MutexGuard<'_, Pending> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Least distance of a hand from the ends of a brace's range, °: beyond them a leg is not armed.
const INSIDE_DEG: f64 = 1.0;

/// Angles between which a hand moves the knee, °.
fn ends_deg() -> [f64; 2] {
    let range = RangeSettings::default();
    [range.least_deg + INSIDE_DEG, range.most_deg - INSIDE_DEG]
}

/// The nearest angle that a hand can move the knee to, °.
pub(crate) fn reachable_deg(angle_deg: f64) -> f64 {
    let [least_deg, most_deg] = ends_deg();
    angle_deg.max(least_deg).min(most_deg)
}

/// These angles for a page.
pub(crate) fn reach() -> Value {
    let [least_deg, most_deg] = ends_deg();
    json!({ "least_deg": least_deg, "most_deg": most_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(angle_deg: f64) -> HandRequest {
        HandRequest {
            page: 1,
            angle_deg,
            holds: true,
        }
    }

    #[test]
    fn of_many_wishes_the_last_one_counts() {
        let requests = HandRequests::default();
        let begun = Instant::now();
        assert_eq!(requests.take(begun), None);
        for angle_deg in 0..1_000 {
            requests.put(request(f64::from(angle_deg)));
        }
        assert_eq!(requests.take(begun), Some(request(999.0)));
        assert_eq!(requests.take(begun + LEAST_INTERVAL), None);
    }

    #[test]
    fn more_than_a_display_shows_waits() {
        let requests = HandRequests::default();
        let begun = Instant::now();
        let mut taken = Vec::new();
        // One every 0.1 ms for a second.
        for n in 0..10_000_u32 {
            let now = begun + n * Duration::from_micros(100);
            requests.put(request(f64::from(n)));
            taken.extend(requests.take(now));
        }
        assert_eq!(taken.len(), 250);
        requests.put(request(-1.0));
        let at_last = begun + Duration::from_secs(1);
        assert_eq!(requests.take(at_last), Some(request(-1.0)));
        // One that comes early is not lost.
        requests.put(request(-2.0));
        assert_eq!(requests.take(at_last + LEAST_INTERVAL / 4), None);
        let later = at_last + LEAST_INTERVAL;
        assert_eq!(requests.take(later), Some(request(-2.0)));
    }

    #[test]
    fn a_hand_stays_within_the_range_of_a_brace() {
        for (asked, reached) in [
            (40.0, 40.0),
            (1e9, 124.0),
            (-1e9, -4.0),
            (f64::INFINITY, 124.0),
        ] {
            assert_eq!(reachable_deg(asked), reached);
        }
        assert_eq!(reach(), json!({ "least_deg": -4.0, "most_deg": 124.0 }));
    }
}

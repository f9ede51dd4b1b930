//! Round-trip times, by the transport's clock.

use crate::request_kind::RequestKind;
use std::time::Duration;

/// Round trips stored for the median, per kind of request.
const REMEMBERED: usize = 256;

/// Round-trip times of one kind of request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundTrip {
    /// Number of replies.
    pub count: u64,
    /// Median of the last 256.
    pub median: Duration,
    /// Maximum.
    pub worst: Duration,
}

/// Round-trip times: from the first request to its reply, retries included.
#[derive(Clone, Debug, Default)]
pub struct RoundTrips {
    kinds: [Times; RequestKind::ALL.len()],
}

#[derive(Clone, Debug, Default)]
struct Times {
    count: u64,
    worst: Duration,
    /// Ring buffer of the last times.
    last: Vec<Duration>,
    next: usize,
}

impl RoundTrips {
    pub(crate) fn took(&mut self, kind: RequestKind, time: Duration) {
        let Some(times) = self.kinds.get_mut(kind.index()) else {
            return;
        };
        times.count += 1;
        times.worst = times.worst.max(time);
        match times.last.get_mut(times.next) {
            Some(place) => *place = time,
            None => times.last.push(time),
        }
        times.next = (times.next + 1) % REMEMBERED;
    }

    /// Times of one kind of request; `None` without replies.
    pub fn of(&self, kind: RequestKind) -> Option<RoundTrip> {
        let times = self.kinds.get(kind.index())?;
        let mut sorted = times.last.clone();
        sorted.sort_unstable();
        Some(RoundTrip {
            count: times.count,
            median: *sorted.get(sorted.len().checked_sub(1)? / 2)?,
            worst: times.worst,
        })
    }

    /// All kinds that had replies.
    pub fn all(&self) -> impl Iterator<Item = (RequestKind, RoundTrip)> {
        RequestKind::ALL
            .into_iter()
            .filter_map(|kind| self.of(kind).map(|times| (kind, times)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_of_recent_times_and_the_maximum_of_all() {
        let mut trips = RoundTrips::default();
        assert_eq!(trips.of(RequestKind::Arm), None);
        let ms = Duration::from_millis;
        trips.took(RequestKind::Arm, ms(900));
        for time in 1..=300 {
            trips.took(RequestKind::Arm, ms(time % 3));
        }
        let arm = trips.of(RequestKind::Arm).unwrap();
        assert_eq!((arm.count, arm.median, arm.worst), (301, ms(1), ms(900)));
        assert_eq!(trips.all().count(), 1);
    }
}

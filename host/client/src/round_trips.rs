//! How long answers take, in the transport's time.

use crate::request_kind::RequestKind;
use std::time::Duration;

/// Round trips of one kind that are remembered for the median.
const REMEMBERED: usize = 256;

/// How long the answers to one kind of request have taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundTrip {
    /// How many answers there were.
    pub count: u64,
    /// Half of the last 256 took at most this long.
    pub median: Duration,
    /// The slowest of all.
    pub worst: Duration,
}

/// How long answers have taken: from the first time that something was asked
/// to its answer, repeats included.
#[derive(Clone, Debug, Default)]
pub struct RoundTrips {
    kinds: [Times; RequestKind::ALL.len()],
}

#[derive(Clone, Debug, Default)]
struct Times {
    count: u64,
    worst: Duration,
    /// The last ones; the oldest is overwritten.
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

    /// How long the answers to this have taken; nothing if there were none.
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

    /// All kinds that were answered.
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
    fn the_median_forgets_and_the_worst_does_not() {
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

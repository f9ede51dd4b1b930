//! Errors of matched events.
//!
//! With t the true time of an event and u the found one, of a matched pair:
//!
//! ```text
//! event error     u − t                       worst, and root mean square
//! interval error  (u′ − u) − (t′ − t)         worst, over pairs that are next to each other on both sides
//! frequency error Σ(t′ − t) / Σ(u′ − u) − 1   over whole cycles: from a break to the next in the same sense,
//!                                             with nothing unmatched in between
//! ```

use crate::matching::Matching;
use crate::true_events::TimedEvent;
use crepitus_model::EventKind;

/// Errors of event times; NaN where there is nothing to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventErrors {
    /// Worst |u − t|, s.
    pub max_s: f64,
    /// Root mean square of u − t, s.
    pub rms_s: f64,
    /// Worst |(u′ − u) − (t′ − t)|, s.
    pub max_interval_s: f64,
    /// |Σ(t′ − t)/Σ(u′ − u) − 1|.
    pub frequency_rel: f64,
}

impl EventErrors {
    /// Unknown errors: all NaN.
    pub const UNKNOWN: Self = Self {
        max_s: f64::NAN,
        rms_s: f64::NAN,
        max_interval_s: f64::NAN,
        frequency_rel: f64::NAN,
    };

    /// The errors of `found` against `truth`.
    pub fn new(truth: &[TimedEvent], found: &[TimedEvent], matching: &Matching) -> Self {
        let pairs: Vec<Pair> = matching
            .pairs
            .iter()
            .filter_map(|&(i, j)| {
                Some(Pair {
                    indices: (i, j),
                    truth: *truth.get(i)?,
                    found_s: found.get(j)?.time_s,
                })
            })
            .collect();
        let mut errors = Self::UNKNOWN;
        let mut squares = 0.0;
        let mut count = 0.0;
        for pair in &pairs {
            let error_s = pair.found_s - pair.truth.time_s;
            // A number wins over NaN.
            errors.max_s = error_s.abs().max(errors.max_s);
            squares += error_s * error_s;
            count += 1.0;
        }
        errors.rms_s = (squares / count).sqrt();
        for (a, b) in neighbours(&pairs) {
            let interval_s = (b.found_s - a.found_s) - (b.truth.time_s - a.truth.time_s);
            errors.max_interval_s = interval_s.abs().max(errors.max_interval_s);
        }
        errors.frequency_rel = frequency_error(&pairs);
        errors
    }
}

/// A true event and when it was found.
#[derive(Clone, Copy, Debug)]
struct Pair {
    indices: (usize, usize),
    truth: TimedEvent,
    found_s: f64,
}

/// Pairs that follow each other on both sides.
fn neighbours(pairs: &[Pair]) -> impl Iterator<Item = (&Pair, &Pair)> {
    pairs.windows(2).filter_map(|w| match w {
        [a, b] if b.indices == (a.indices.0 + 1, a.indices.1 + 1) => Some((a, b)),
        _ => None,
    })
}

fn frequency_error(pairs: &[Pair]) -> f64 {
    let (mut true_s, mut found_s) = (0.0, 0.0);
    // The break that the current cycle began with.
    let mut start: Option<&Pair> = None;
    let mut before: Option<(usize, usize)> = None;
    for pair in pairs {
        let follows = before.is_none_or(|(i, j)| pair.indices == (i + 1, j + 1));
        before = Some(pair.indices);
        if !follows {
            start = None;
        }
        if pair.truth.kind != EventKind::Break {
            continue;
        }
        if let Some(start) = start.filter(|s| s.truth.sense == pair.truth.sense) {
            true_s += pair.truth.time_s - start.truth.time_s;
            found_s += pair.found_s - start.found_s;
        }
        start = Some(pair);
    }
    // 0/0 without a cycle.
    (true_s / found_s - 1.0).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::match_events;
    use crepitus_model::Sense;

    fn event(time_s: f64, kind: EventKind, sense: Sense) -> TimedEvent {
        TimedEvent {
            time_s,
            kind,
            sense,
        }
    }

    /// Breaks every 30 ms, sticks 1 ms before the next.
    fn cycles(count: u32) -> Vec<TimedEvent> {
        (0..count)
            .flat_map(|n| {
                let start = 30e-3 * f64::from(n + 1);
                [
                    event(start, EventKind::Break, Sense::Positive),
                    event(start + 29e-3, EventKind::Stick, Sense::Positive),
                ]
            })
            .collect()
    }

    fn errors(truth: &[TimedEvent], found: &[TimedEvent]) -> EventErrors {
        let matching = match_events(truth, found, 1e-4, 10.0);
        EventErrors::new(truth, found, &matching)
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn a_constant_delay_is_no_interval_and_no_frequency_error() {
        let truth = cycles(10);
        let found: Vec<_> = truth
            .iter()
            .map(|e| event(e.time_s + 2e-3, e.kind, e.sense))
            .collect();
        let e = errors(&truth, &found);
        assert!(near(e.max_s, 2e-3) && near(e.rms_s, 2e-3), "{e:?}");
        assert!(
            near(e.max_interval_s, 0.0) && near(e.frequency_rel, 0.0),
            "{e:?}"
        );
    }

    #[test]
    fn a_stretch_is_a_frequency_error() {
        let truth = cycles(10);
        let found: Vec<_> = truth
            .iter()
            .map(|e| event(e.time_s * 1.01, e.kind, e.sense))
            .collect();
        let e = errors(&truth, &found);
        assert!(near(e.frequency_rel, 1.0 - 1.0 / 1.01), "{e:?}");
        // The last event is at 329 ms, the longest interval lasts 29 ms.
        assert!(
            near(e.max_s, 3.29e-3) && near(e.max_interval_s, 0.29e-3),
            "{e:?}"
        );
    }

    #[test]
    fn one_late_event_counts_in_both_its_intervals_but_not_in_the_frequency() {
        let truth = cycles(10);
        let mut found = truth.clone();
        found[4].time_s += 0.5e-3;
        let e = errors(&truth, &found);
        assert!(near(e.max_s, 0.5e-3) && near(e.max_interval_s, 0.5e-3));
        assert!(near(e.rms_s, 0.5e-3 / 20_f64.sqrt()));
        assert!(near(e.frequency_rel, 0.0));
    }

    #[test]
    fn a_lost_cycle_leaves_a_gap_that_is_neither_interval_nor_cycle() {
        let truth = cycles(10);
        let mut found = truth.clone();
        found.drain(8..10);
        let e = errors(&truth, &found);
        assert_eq!(
            (e.max_s, e.max_interval_s, e.frequency_rel),
            (0.0, 0.0, 0.0)
        );
    }

    #[test]
    fn a_reversal_is_no_cycle() {
        let mut truth = cycles(2);
        truth.push(event(1.0, EventKind::Break, Sense::Negative));
        truth.push(event(1.02, EventKind::Stick, Sense::Negative));
        let mut found = truth.clone();
        found[4].time_s += 5e-3;
        assert_eq!(errors(&truth, &found).frequency_rel, 0.0);
    }

    #[test]
    fn without_events_nothing_is_known() {
        let e = errors(&[], &[]);
        assert!(e.max_s.is_nan() && e.rms_s.is_nan());
        let one = &cycles(1)[..1];
        let e = errors(one, one);
        assert_eq!(e.max_s, 0.0);
        assert!(e.max_interval_s.is_nan() && e.frequency_rel.is_nan());
    }
}

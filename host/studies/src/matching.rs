//! Matching of a solver's events with those of the reference.
//!
//! Events are matched one to one in the order of time. Partners are of the
//! same kind and sense, and the found one is as late as the pair before it to
//! within half the cycle around the true one. So a solver whose cycles are a
//! little too long may accumulate any delay, while a cycle that is
//! lost or added is detected: delay does not jump by a cycle.
//!
//! An event without a partner is unmatched, unless it lies within two steps or
//! one cycle of the end of the run, whichever is longer: there a late event
//! has its partner beyond the end. A solver with a larger delay has the wrong
//! number of events. That cycle is the shortest of the scene, so that the
//! exception is as narrow as possible.

use crate::true_events::TimedEvent;
use crepitus_model::EventKind;

/// The result of a matching.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matching {
    /// Index of the true event, index of the found one; both ascend.
    pub pairs: Vec<(usize, usize)>,
    /// Interior events of either side without a partner.
    pub unmatched: u64,
}

/// Matches `found` against `truth`, both in the order of time, in a run that
/// ends at `end_s` with steps of `step_s`.
pub fn match_events(
    truth: &[TimedEvent],
    found: &[TimedEvent],
    step_s: f64,
    end_s: f64,
) -> Matching {
    let cycle_s = shortest_cycle(truth);
    match_alike(truth, found, end_s - (2.0 * step_s).max(cycle_s))
}

/// Something that happens at a time.
pub trait Alike: Copy {
    /// Time since the start of the run, s.
    fn time_s(&self) -> f64;

    /// Returns whether both are of one kind.
    fn is_like(&self, other: &Self) -> bool;
}

impl Alike for TimedEvent {
    fn time_s(&self) -> f64 {
        self.time_s
    }

    fn is_like(&self, other: &Self) -> bool {
        Self::is_like(self, other)
    }
}

/// Matches events of any kind like [`match_events`], with those after `interior_s` exempt.
pub fn match_alike<E: Alike>(truth: &[E], found: &[E], interior_s: f64) -> Matching {
    let gaps = gaps(truth);
    let mut matching = Matching::default();
    let mut alone = |event: &E| {
        if event.time_s() < interior_s {
            matching.unmatched += 1;
        }
    };
    let (mut i, mut j) = (0, 0);
    // How late the last pair was, s.
    let mut late_s = 0.0;
    loop {
        match (truth.get(i), found.get(j)) {
            (Some(t), Some(f)) => {
                let reach_s = gaps.get(i).map_or(f64::INFINITY, |gap_s| gap_s / 2.0);
                // Where the partner is due.
                let due_s = t.time_s() + late_s;
                if t.is_like(f) && (f.time_s() - due_s).abs() < reach_s {
                    late_s = f.time_s() - t.time_s();
                    matching.pairs.push((i, j));
                    i += 1;
                    j += 1;
                } else if due_s <= f.time_s() {
                    alone(t);
                    i += 1;
                } else {
                    alone(f);
                    j += 1;
                }
            }
            (Some(t), None) => {
                alone(t);
                i += 1;
            }
            (None, Some(f)) => {
                alone(f);
                j += 1;
            }
            (None, None) => return matching,
        }
    }
}

/// The cycle around each event: time to the nearer neighbour of the same kind
/// and sense, s; infinite where there is none.
fn gaps<E: Alike>(events: &[E]) -> Vec<f64> {
    let mut gaps = vec![f64::INFINITY; events.len()];
    let mut last: Vec<(usize, E)> = Vec::new();
    for (index, event) in events.iter().enumerate() {
        if let Some(before) = last.iter_mut().find(|(_, e)| e.is_like(event)) {
            let gap_s = event.time_s() - before.1.time_s();
            for neighbour in [before.0, index] {
                if let Some(gap) = gaps.get_mut(neighbour) {
                    *gap = gap_s.min(*gap);
                }
            }
            *before = (index, *event);
        } else {
            last.push((index, *event));
        }
    }
    gaps
}

/// The shortest time from break to break in the same sense, s; 0 without one.
fn shortest_cycle(events: &[TimedEvent]) -> f64 {
    let breaks: Vec<_> = events
        .iter()
        .filter(|e| e.kind == EventKind::Break)
        .collect();
    let shortest = breaks
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] if a.sense == b.sense => Some(b.time_s - a.time_s),
            _ => None,
        })
        .fold(f64::INFINITY, f64::min);
    if shortest.is_finite() { shortest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::Sense;

    /// End of the run, s: with ten cycles, all but the last stick are more than a cycle away.
    const END_S: f64 = 0.305;

    /// Cycles of 30 ms: a break, 29 ms later a stick.
    fn cycles(count: u32, stretch: f64) -> Vec<TimedEvent> {
        (0..count)
            .flat_map(|n| {
                let start = 1e-3 + f64::from(n) * 30e-3;
                [(EventKind::Break, start), (EventKind::Stick, start + 29e-3)]
            })
            .map(|(kind, time_s)| TimedEvent {
                time_s: time_s * stretch,
                kind,
                sense: Sense::Positive,
            })
            .collect()
    }

    fn matched(truth: &[TimedEvent], found: &[TimedEvent]) -> (usize, u64) {
        let matching = match_events(truth, found, 1e-4, END_S);
        (matching.pairs.len(), matching.unmatched)
    }

    #[test]
    fn the_same_events_match_all() {
        let truth = cycles(10, 1.0);
        assert_eq!(matched(&truth, &truth), (20, 0));
    }

    #[test]
    fn an_event_that_falls_past_the_end_is_no_fault() {
        let truth = cycles(10, 1.0);
        assert_eq!(matched(&truth, &truth[..19]), (19, 0));
        assert_eq!(matched(&truth[..19], &truth), (19, 0));
        // The break before it is more than a cycle from the end.
        assert_eq!(matched(&truth, &truth[..18]), (18, 1));
    }

    #[test]
    fn a_lost_cycle_is_found_and_what_follows_matches_again() {
        let truth = cycles(10, 1.0);
        let mut found = truth.clone();
        found.drain(8..10);
        let matching = match_events(&truth, &found, 1e-4, END_S);
        assert_eq!((matching.pairs.len(), matching.unmatched), (18, 2));
        assert_eq!(matching.pairs[8], (10, 8));
        // And the other way round: a cycle too many.
        assert_eq!(matched(&found, &truth), (18, 2));
    }

    #[test]
    fn a_growing_delay_stays_matched_until_a_cycle_is_missing_at_the_end() {
        let truth = cycles(10, 1.0);
        let behind = |stretch| {
            let mut found = cycles(10, stretch);
            found.retain(|e| e.time_s < END_S);
            matched(&truth, &found)
        };
        assert_eq!(behind(1.01), (20, 0));
        // Behind by 24 ms at the end, more than half a cycle.
        assert_eq!(behind(1.08), (19, 0));
        // By 54 ms.
        let (pairs, unmatched) = behind(1.2);
        assert!(pairs < 18 && unmatched >= 1, "{pairs} {unmatched}");
        // Ahead of time there are too many.
        assert_eq!(matched(&truth, &cycles(11, 0.9)), (20, 1));
    }

    #[test]
    fn a_cycle_lost_by_a_late_solver_is_found_too() {
        let truth = cycles(10, 1.0);
        let mut found = cycles(10, 1.05);
        found.drain(12..14);
        let matching = match_events(&truth, &found, 1e-4, END_S);
        assert_eq!(matching.unmatched, 2);
        assert_eq!(matching.pairs[12], (14, 12));
    }

    #[test]
    fn the_other_sense_is_another_event() {
        let truth = cycles(10, 1.0);
        let mut found = truth.clone();
        found[6].sense = Sense::Negative;
        assert_eq!(matched(&truth, &found), (19, 2));
    }

    #[test]
    fn a_solver_that_never_sticks_loses_everything() {
        let truth = cycles(10, 1.0);
        assert_eq!(matched(&truth, &truth[..1]), (1, 18));
        assert_eq!(matched(&[], &[]), (0, 0));
    }

    #[test]
    fn a_single_event_matches_however_far_it_is() {
        let truth = &cycles(1, 1.0)[..1];
        let found = TimedEvent {
            time_s: 0.2,
            ..truth[0]
        };
        assert_eq!(matched(truth, &[found]), (1, 0));
    }
}

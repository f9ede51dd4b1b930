//! The first root of a smooth function, found with certainty.
//!
//! With |g̈| ≤ M ahead, g(t + d) ≥ g + ġ·d − M·d²/2, so no root lies before
//! d = (ġ + √(ġ² + 2M·g))/M. The search goes there, looks again, and cannot
//! step over a root however short the excursion below zero is. Near a simple
//! root this is Newton's step from the one side.
//!
//! Within rounding of zero the sign of g says nothing. Where a touch passes, a
//! root counts once g has fallen below zero by more than rounding, and its time
//! is that of Newton's step into the band; a g that leaves the band upwards has
//! touched zero without crossing it. Where a touch counts, it is enough that g
//! comes down into the band. A g that begins in the band has to leave it first.

use std::ops::ControlFlow;

/// Number of evaluations between two calls of `poll`.
const POLL_EVERY: u32 = 1 << 12;

/// A function at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// g, positive until the event.
    pub(super) value: f64,
    /// ġ.
    pub(super) slope: f64,
    /// A bound of |g̈| from here to the end of the search.
    pub(super) bound: f64,
    /// Part of `value` that may be rounding.
    pub(super) noise: f64,
    /// Depth below zero that still counts as at zero; at least `noise`.
    pub(super) slack: f64,
}

impl Sample {
    /// Time ahead in which g surely stays above `-below`, s, from the parabola that
    /// bounds it from below; infinite where nothing bends it down.
    fn clear_s(&self, below: f64) -> f64 {
        let height = self.value + below;
        let root = (self.slope * self.slope + 2.0 * self.bound * height).sqrt();
        if self.slope > 0.0 {
            (self.slope + root) / self.bound
        } else {
            let ahead_s = 2.0 * height / (root - self.slope);
            if !ahead_s.is_nan() {
                ahead_s
            } else if self.bound > 0.0 {
                // 0/0: at zero, and it may bend down at once.
                0.0
            } else {
                // At rest from now on, so never below.
                f64::INFINITY
            }
        }
    }
}

/// Meaning of a g that comes down to zero, as far as rounding tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Touch {
    /// No root until g is below zero.
    Passes,
    /// The touch is the root, for a g that comes from above; whether it does at the
    /// start of the search, too.
    Counts { from_above: bool },
}

/// The first time in [`from_s`, `to_s`] at which `sample` falls to zero.
///
/// A function that begins at zero and does not fall is not at a root; one that
/// begins below zero by more than its slack is, at once.
///
/// # Errors
/// The value that `poll` breaks with; `poll` is called now and then, so that no search is
/// without an end.
pub(super) fn first_root<B>(
    from_s: f64,
    to_s: f64,
    touch: Touch,
    poll: &mut impl FnMut() -> ControlFlow<B>,
    mut sample: impl FnMut(f64) -> Sample,
) -> ControlFlow<B, Option<f64>> {
    let mut time_s = from_s;
    let mut from_above = touch == Touch::Counts { from_above: true };
    // Where g falls to zero, if it is at zero now and falls.
    let mut root_s = None;
    let mut count = 0_u32;
    let least_s = f64::EPSILON * (to_s - from_s);
    loop {
        let g = sample(time_s);
        if g.value < -g.slack {
            return ControlFlow::Continue(Some(root_s.unwrap_or(time_s)));
        }
        let ahead_s = if g.value > g.noise {
            root_s = None;
            from_above = touch != Touch::Passes;
            g.clear_s(0.0)
        } else {
            let within_s = g.clear_s(2.0 * g.slack);
            if g.slope >= 0.0 {
                root_s = None;
            } else if root_s.is_none() {
                // Where the slope is rounding, too, Newton's step may lead anywhere.
                let newton_s = (-g.value / g.slope).min(within_s);
                root_s = Some((time_s + newton_s).max(from_s).min(to_s));
            }
            if from_above && root_s.is_some() {
                return ControlFlow::Continue(root_s);
            }
            within_s
        };
        // Progress by at least one representable time, and not by one of those
        // that lie densely around zero: the search ends.
        time_s = (time_s + ahead_s.max(least_s)).max(time_s.next_up());
        // Nothing follows an infinite time, and nothing can be known of it.
        if time_s > to_s || time_s.is_infinite() {
            return ControlFlow::Continue(None);
        }
        count = count.wrapping_add(1);
        if count.is_multiple_of(POLL_EVERY) {
            poll()?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(from_s: f64, to_s: f64, sample: impl FnMut(f64) -> Sample) -> Option<f64> {
        search_with(Touch::Passes, from_s, to_s, sample)
    }

    fn search_with(
        touch: Touch,
        from_s: f64,
        to_s: f64,
        sample: impl FnMut(f64) -> Sample,
    ) -> Option<f64> {
        let mut proceed = || ControlFlow::<()>::Continue(());
        match first_root(from_s, to_s, touch, &mut proceed, sample) {
            ControlFlow::Continue(found) => found,
            ControlFlow::Break(()) => None,
        }
    }

    /// g = a − cos t, whose first root is acos a.
    fn cosine(a: f64) -> impl FnMut(f64) -> Sample {
        move |t| Sample {
            value: a - t.cos(),
            slope: t.sin(),
            bound: 1.0,
            noise: 4.0 * f64::EPSILON,
            slack: 4.0 * f64::EPSILON,
        }
    }

    #[test]
    fn finds_an_excursion_of_a_millionth() {
        // Below zero only for 2·√(2·1e-12) around 2π.
        let a: f64 = 1.0 - 1e-12;
        let root = search(0.5, 20.0, cosine(a)).unwrap();
        let expected = std::f64::consts::TAU - a.acos();
        assert!((root - expected).abs() < 1e-9, "{root} {expected}");
    }

    #[test]
    fn does_not_find_what_is_not_there() {
        assert_eq!(search(0.5, 20.0, cosine(1.0 + 1e-12)), None);
        let root = search(0.5, 5.0, cosine(0.5)).unwrap();
        assert!(
            (root - 5.0 * std::f64::consts::FRAC_PI_3).abs() > 0.1,
            "that is the second: {root}"
        );
    }

    #[test]
    fn a_touch_is_no_root_and_a_start_at_zero_is_none() {
        // 1 − cos t touches zero at 0, 2π, 4π …
        assert_eq!(search(0.0, 100.0, cosine(1.0)), None);
        // Where it counts the first is that at 2π, from above.
        let counts = |from_above| Touch::Counts { from_above };
        let root = search_with(counts(false), 0.0, 100.0, cosine(1.0)).unwrap();
        assert!((root - std::f64::consts::TAU).abs() < 1e-7, "{root}");
        // In the band from the start and falling: it depends on from where.
        let falls = |t: f64| Sample {
            value: 1e-17 - 1e-20 * t,
            slope: -1e-20,
            bound: 0.0,
            noise: 1e-16,
            slack: 1e-16,
        };
        assert_eq!(search_with(counts(false), 0.0, 1.0, falls), None);
        assert!(search_with(counts(true), 0.0, 1.0, falls).is_some());
    }

    #[test]
    fn a_start_at_zero_is_judged_by_where_it_goes() {
        let line = |slope: f64| {
            move |t: f64| Sample {
                value: slope * t,
                slope,
                bound: 0.0,
                noise: 1e-15,
                slack: 1e-9,
            }
        };
        assert_eq!(search(0.0, 1.0, line(1.0)), None);
        assert_eq!(search(0.0, 1.0, line(-1.0)), Some(0.0));
        assert_eq!(search(0.0, 1.0, line(0.0)), None);
    }

    /// The torque of a joint that starts from rest, below a limit that has nearly decayed.
    #[test]
    fn a_start_with_a_slope_of_rounding_does_not_find_its_root_late() {
        let starts = |t: f64| Sample {
            value: 1e-25 * (-t / 0.02).exp() - 100.0 * t * t,
            slope: -1e-25 / 0.02 - 200.0 * t,
            bound: 200.0,
            noise: 1e-12,
            slack: 2e-12,
        };
        for touch in [Touch::Passes, Touch::Counts { from_above: true }] {
            let root = search_with(touch, 0.0, 1.0, starts).unwrap();
            assert!(root < 1e-6, "{root:e}");
        }
    }

    #[test]
    fn a_search_without_an_end_ends_where_nothing_follows() {
        let slow = |time_s: f64| Sample {
            value: 0.4 - 1e-318 * time_s,
            slope: -1e-318,
            bound: 0.0,
            noise: 1e-16,
            slack: 1e-16,
        };
        let mut endless = || ControlFlow::Break("it goes on");
        let found = first_root(0.0, f64::INFINITY, Touch::Passes, &mut endless, slow);
        assert_eq!(found, ControlFlow::Continue(None));
    }

    /// A dead object on a shaft that starts from rest: g = −t² with g, ġ and
    /// what rounding could hide all exactly 0 at the start.
    #[test]
    fn a_start_from_rest_without_any_rounding_is_not_stepped_over() {
        let start = |t: f64| Sample {
            value: -(t * t),
            slope: -2.0 * t,
            bound: 2.0,
            noise: f64::EPSILON * t,
            slack: f64::EPSILON * t,
        };
        let root = search(0.0, 1.0, start).unwrap();
        assert!(root < 1e-12, "{root:e}");
    }

    #[test]
    fn a_long_search_asks_whether_it_may_continue() {
        // Bounds a million times too large make it crawl.
        let crawl = |t: f64| Sample {
            value: 1.0 + t,
            slope: 1.0,
            bound: 1e12,
            noise: 0.0,
            slack: 0.0,
        };
        let mut polls = 0;
        let found = first_root(
            0.0,
            1e9,
            Touch::Passes,
            &mut || {
                polls += 1;
                if polls == 3 {
                    ControlFlow::Break("enough")
                } else {
                    ControlFlow::Continue(())
                }
            },
            crawl,
        );
        assert_eq!((found, polls), (ControlFlow::Break("enough"), 3));
    }
}

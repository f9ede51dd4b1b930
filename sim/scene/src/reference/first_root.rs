//! The first root of a smooth function, found with certainty.
//!
//! With |g̈| ≤ M ahead, g(t + d) ≥ g + ġ·d − M·d²/2, so no root lies before
//! d = (ġ + √(ġ² + 2M·g))/M. The search goes there, looks again, and cannot
//! step over a root however short the excursion below zero is. Near a simple
//! root this is Newton's step from the one side.

/// A function at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// g, positive until the event.
    pub(super) value: f64,
    /// ġ.
    pub(super) slope: f64,
    /// A bound of |g̈| from here to the end of the search.
    pub(super) bound: f64,
    /// What of `value` may be rounding.
    pub(super) noise: f64,
    /// How far below zero still counts as at zero, where the slope decides.
    pub(super) slack: f64,
}

/// The first time in [`from_s`, `to_s`] at which `sample` falls to zero.
///
/// A function that begins at zero and does not fall is not at a root; one that
/// begins below zero by more than its slack is, at once.
pub(super) fn first_root(
    from_s: f64,
    to_s: f64,
    mut sample: impl FnMut(f64) -> Sample,
) -> Option<f64> {
    let mut time_s = from_s;
    loop {
        let g = sample(time_s);
        if g.value < -g.slack {
            return Some(time_s);
        }
        let advance_s = if g.value <= g.noise {
            if g.slope < 0.0 {
                return Some((time_s + g.value.max(0.0) / -g.slope).min(to_s));
            }
            // Leaving zero: the parabola is back there at 2ġ/M.
            2.0 * g.slope / g.bound
        } else {
            let root = (g.slope * g.slope + 2.0 * g.bound * g.value).sqrt();
            if g.slope > 0.0 {
                (g.slope + root) / g.bound
            } else {
                2.0 * g.value / (root - g.slope)
            }
        };
        // 0/0: at zero for ever, so never below it.
        if advance_s.is_nan() {
            return None;
        }
        // Progress by at least one representable time: the search ends.
        time_s = (time_s + advance_s).max(time_s.next_up());
        if time_s > to_s {
            return None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let root = first_root(0.5, 20.0, cosine(a)).unwrap();
        let expected = std::f64::consts::TAU - a.acos();
        assert!((root - expected).abs() < 1e-9, "{root} {expected}");
    }

    #[test]
    fn does_not_find_what_is_not_there() {
        assert_eq!(first_root(0.5, 20.0, cosine(1.0 + 1e-12)), None);
        let root = first_root(0.5, 5.0, cosine(0.5)).unwrap();
        assert!(
            (root - 5.0 * std::f64::consts::FRAC_PI_3).abs() > 0.1,
            "that is the second: {root}"
        );
    }

    #[test]
    fn a_start_at_zero_is_judged_by_its_slope() {
        let line = |slope: f64| {
            move |t: f64| Sample {
                value: slope * t,
                slope,
                bound: 0.0,
                noise: 1e-15,
                slack: 1e-9,
            }
        };
        assert_eq!(first_root(0.0, 1.0, line(1.0)), None);
        assert_eq!(first_root(0.0, 1.0, line(-1.0)), Some(0.0));
        assert_eq!(first_root(0.0, 1.0, line(0.0)), None);
    }
}

//! Time at which a torque that is a parabola in time reaches a limit.

/// Distance to a limit: left − rate·u − curvature·u²/2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola {
    pub(super) left: f64,
    pub(super) rate: f64,
    pub(super) curvature: f64,
}

impl Parabola {
    /// The first u ≥ 0 at which nothing is left and less than nothing follows;
    /// what is beyond the limit by more than `slack` is there at once.
    ///
    /// Each root is written as the one of its two forms that does not subtract
    /// like numbers.
    pub(super) fn first_root(&self, slack: f64) -> Option<f64> {
        let Self {
            left,
            rate,
            curvature,
        } = *self;
        let turns_back =
            curvature < 0.0 && rate * rate <= -2.0 * curvature * (slack + left.min(0.0));
        if left < -slack || (left <= 0.0 && rate > 0.0 && !turns_back) {
            return Some(0.0);
        }
        let left = left.max(0.0);
        if rate > 0.0 {
            let square = rate * rate + 2.0 * curvature * left;
            // The parabola's top is at the limit, to rounding: the limit itself still holds.
            if curvature < 0.0 && square <= -2.0 * curvature * slack {
                return None;
            }
            return (square >= 0.0).then(|| 2.0 * left / (rate + square.sqrt()));
        }
        // First away from the limit, then towards it.
        (curvature > 0.0).then(|| {
            let square = rate * rate + 2.0 * curvature * left;
            (square.sqrt() - rate) / curvature
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(left: f64, rate: f64, curvature: f64) -> Option<f64> {
        let parabola = Parabola {
            left,
            rate,
            curvature,
        };
        parabola.first_root(1e-12)
    }

    #[test]
    fn every_way_to_reach_the_limit() {
        assert_eq!(root(1.0, 2.0, 0.0), Some(0.5));
        assert_eq!(root(1.5, 1.0, 1.0), Some(1.0));
        assert_eq!(root(1.0, 0.0, 2.0), Some(1.0));
        assert_eq!(root(1.5, -1.0, 1.0), Some(3.0));
        // Slowing down short of it, at rest, going away.
        assert_eq!(root(1.0, 1.0, -1.0), None);
        assert_eq!(root(1.0, 0.0, 0.0), None);
        assert_eq!(root(1.0, -1.0, 0.0), None);
        assert_eq!(root(1.0, -1.0, -1.0), None);
    }

    #[test]
    fn at_the_limit_it_is_where_it_goes_that_counts() {
        // A top at the limit, and one beyond it.
        assert_eq!(root(1.0, 2.0, -2.0), None);
        assert_eq!(root(1.0, 2.0, -2.0 + 1e-9).map(|u| u > 0.9), Some(true));
        for left in [0.0, -1e-13] {
            assert_eq!(root(left, 1.0, -5.0), Some(0.0));
            assert_eq!(root(left, 1e-7, -5.0), None);
            assert_eq!(root(left, 0.0, 1.0), Some(0.0));
            assert_eq!(root(left, -1.0, 4.0), Some(0.5));
            assert_eq!(root(left, -1.0, 0.0), None);
        }
        assert_eq!(root(-1e-6, -1.0, -1.0), Some(0.0));
    }

    #[test]
    fn near_the_limit_and_going_away_no_digit_is_lost() {
        // Back after 2 s and a little: u = 1 + √(1 + 2e-12).
        let u = root(1e-12, -1.0, 1.0).unwrap();
        assert!((u - (2.0 + 1e-12)).abs() < 5e-16, "{u:e}");
    }
}

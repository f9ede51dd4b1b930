//! Range of motion: towards its ends the torque fades, beyond them there is none.
//!
//! ```text
//! share 1         ╱‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾╲
//!       0 ───────╱                   ╲───────
//!        ╎fault  │ fade         fade │  fault╎
//!        ╎  least_deg             most_deg   ╎
//! ```

use crepitus_model::Real;
use crepitus_protocol::Fault;

/// Ticks beyond the range, by more than a fade, until that is a fault.
const OUTSIDE_TICKS: u32 = 20;

/// Coefficients of the range of motion.
#[derive(Clone, Copy, Debug)]
pub struct RangePlan {
    /// End of the range in extension, counts from the angle's zero.
    pub least: i32,
    /// End of the range in flexion.
    pub most: i32,
    /// Share of the torque for a count.
    pub share_per_count: f32,
}

/// Follows the leg in its range.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    plan: RangePlan,
    outside_ticks: u32,
}

impl Range {
    /// A range with a leg somewhere.
    pub fn new(plan: &RangePlan) -> Self {
        Self {
            plan: *plan,
            outside_ticks: 0,
        }
    }

    /// Fades to the nearer end from this count from zero; below 0 beyond it.
    pub fn fades_left(&self, count: i32) -> f32 {
        let RangePlan { least, most, .. } = self.plan;
        let counts = (count.saturating_sub(least)).min(most.saturating_sub(count));
        #[expect(clippy::cast_precision_loss, reason = "exact where a fade is")]
        let counts = counts as f32;
        counts * self.plan.share_per_count
    }

    /// Checks a tick of a device that is armed or arming.
    pub fn check(&mut self, fades_left: f32) -> Option<Fault> {
        self.outside_ticks = if fades_left < -1.0 {
            self.outside_ticks.saturating_add(1)
        } else {
            0
        };
        (self.outside_ticks >= OUTSIDE_TICKS).then_some(Fault::OutsideRange)
    }
}

/// Share of the torque, 0 to 1.
pub fn share(fades_left: f32) -> f32 {
    fades_left.at_least(0.0).at_most(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// −100 to 400 counts, with a fade of 50.
    fn range() -> Range {
        Range::new(&RangePlan {
            least: -100,
            most: 400,
            share_per_count: 0.02,
        })
    }

    #[test]
    fn the_torque_fades_to_nothing_at_both_ends() {
        for (count, expected) in [
            (0, 1.0),
            (-50, 1.0),
            (350, 1.0),
            (-75, 0.5),
            (375, 0.5),
            (-100, 0.0),
            (400, 0.0),
            (-101, 0.0),
            (401, 0.0),
            (i32::MIN, 0.0),
            (i32::MAX, 0.0),
        ] {
            let left = range().fades_left(count);
            assert_eq!(share(left), expected, "{count}");
            assert_eq!(left >= 0.0, (-100..=400).contains(&count));
        }
    }

    #[test]
    fn a_fade_beyond_an_end_is_a_fault_after_a_millisecond() {
        for (count, faults) in [
            (i32::MIN, true),
            (-151, true),
            (-150, false),
            (450, false),
            (451, true),
            (i32::MAX, true),
        ] {
            let mut range = range();
            let left = range.fades_left(count);
            let after = (1..100).find(|_| range.check(left).is_some());
            assert_eq!(after, faults.then_some(OUTSIDE_TICKS), "{count}");
        }
        let mut range = range();
        assert!((0..100).all(|n| range.check(if n % 20 == 19 { 1.0 } else { -5.0 }).is_none()));
    }
}

//! The plan of a blind trial: one for all knees, as the motion is seen.
//!
//! ```text
//!  slowly to both ends, in bits ── fast stretch ── fall ── fast, and held ── back
//! ```
//!
//! It shows the signs of every knee that ships, and the stiffest one does not overload gear and motor: movements are
//! short in time, the hand eases off behind each, and then rests.

use crate::leg::movement::Movement;

/// Way by which the hand eases off, °: less than makes a turn of it, and enough for gear and motor to bear for ever what
/// is left of the largest torque. Its speed, °/s.
pub(super) const EASE_DEG: f64 = 2.5;
const EASE_DEG_S: f64 = 30.0;

/// Speeds, °/s: below the threshold of a catch, on the way back, of a stretch, and of a fall.
const SLOW_DEG_S: f64 = 35.0;
const BACK_DEG_S: f64 = 90.0;
const STRETCH_DEG_S: f64 = 200.0;
const FALL_DEG_S: f64 = 170.0;

/// Longest movements, °: which the largest torque warms as much as the rest behind cools.
const SLOW_BIT_DEG: f64 = 16.0;
const BACK_BIT_DEG: f64 = 32.0;

/// Rests, s: after a movement that warms much, on the way back, and of a leg that is held.
const REST_S: f64 = 0.9;
const BACK_S: f64 = 0.5;
const HOLD_S: f64 = 3.0;

/// Angle at which the plan begins, °.
const BEGIN_DEG: f64 = 10.0;

/// A way in one movement, or in several.
struct Way {
    to_deg: f64,
    deg_s: f64,
    /// Longest movement, °.
    bit_deg: f64,
    /// Rest behind each, s.
    rest_s: f64,
}

impl Way {
    /// Slowly to an end.
    const fn slow(to_deg: f64) -> Self {
        Self {
            to_deg,
            deg_s: SLOW_DEG_S,
            bit_deg: SLOW_BIT_DEG,
            rest_s: REST_S,
        }
    }

    /// Back to where a movement begins.
    const fn back(to_deg: f64) -> Self {
        Self {
            to_deg,
            deg_s: BACK_DEG_S,
            bit_deg: BACK_BIT_DEG,
            rest_s: BACK_S,
        }
    }

    /// Fast, in one movement.
    const fn fast(to_deg: f64, deg_s: f64, rest_s: f64) -> Self {
        Self {
            to_deg,
            deg_s,
            bit_deg: f64::INFINITY,
            rest_s,
        }
    }
}

/// Ways of the plan.
const WAYS: [Way; 9] = [
    Way::slow(118.0),
    Way::back(-1.0),
    Way::back(25.0),
    Way::fast(105.0, STRETCH_DEG_S, REST_S),
    Way::back(25.0),
    Way::fast(105.0, FALL_DEG_S, REST_S),
    Way::back(30.0),
    Way::fast(80.0, STRETCH_DEG_S, HOLD_S),
    Way::back(BEGIN_DEG),
];

/// The movements, one after another and again.
pub(super) fn plan() -> Vec<Movement> {
    eased(BEGIN_DEG, &WAYS)
}

/// The movements that lead to the plan, behind this one.
pub(super) fn way_to(before: Movement) -> Vec<Movement> {
    eased(before.to_rad.to_degrees(), &[Way::back(BEGIN_DEG)])
}

/// The movements of these ways, the hand easing off behind each.
fn eased(from_deg: f64, ways: &[Way]) -> Vec<Movement> {
    let (mut movements, mut at_deg) = (Vec::new(), from_deg);
    for way in ways {
        let sense = (way.to_deg - at_deg).signum();
        let mut left_deg = (way.to_deg - at_deg).abs();
        if left_deg <= 2.0 * EASE_DEG {
            // It is there already.
            continue;
        }
        loop {
            let bit_deg = left_deg.min(way.bit_deg);
            movements.push(Movement::new(at_deg + sense * bit_deg, way.deg_s, 0.0));
            at_deg += sense * (bit_deg - EASE_DEG);
            movements.push(Movement::new(at_deg, EASE_DEG_S, way.rest_s));
            if left_deg <= way.bit_deg {
                break;
            }
            left_deg -= bit_deg - EASE_DEG;
        }
    }
    movements
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends of the movements, without those in which the hand eases off, °.
    fn ends_deg(movements: &[Movement]) -> Vec<f64> {
        let all = movements.iter().step_by(2);
        all.map(|movement| (10.0 * movement.to_rad.to_degrees()).round() / 10.0)
            .collect()
    }

    #[test]
    fn the_plan_goes_to_both_ends_in_bits_and_has_all_steps() {
        let plan = plan();
        let ends = ends_deg(&plan);
        assert_eq!(ends[..3], [26.0, 39.5, 53.0]);
        for end in [118.0, -1.0, 105.0, 80.0, 10.0] {
            assert!(ends.contains(&end), "{end}: {ends:?}");
        }
        let fastest = plan.iter().map(|movement| movement.peak_rad_s);
        assert!((fastest.fold(0.0, f64::max).to_degrees() - STRETCH_DEG_S).abs() < 1e-9);
        assert!(plan.iter().any(|movement| movement.rest_s == HOLD_S));
        // Every second movement goes back a little.
        let mut at_deg = BEGIN_DEG;
        let eased = plan.iter().skip(1).step_by(2);
        for (there, back) in plan.iter().step_by(2).zip(eased) {
            let [there, back] = [there, back].map(|movement| movement.to_rad.to_degrees());
            let sense = (there - at_deg).signum();
            assert!((sense * (there - back) - EASE_DEG).abs() < 1e-9);
            at_deg = back;
        }
    }

    #[test]
    fn from_anywhere_a_leg_is_led_to_where_the_plan_begins() {
        for (from_deg, expected) in [
            (8.0, Vec::new()),
            (-1.0, vec![10.0]),
            (60.0, vec![28.0, 10.0]),
        ] {
            let before = Movement::new(from_deg, EASE_DEG_S, 0.0);
            assert_eq!(ends_deg(&way_to(before)), expected, "{from_deg}");
        }
    }
}

//! Both events located exactly: the break as the root of a parabola, the
//! velocity match by a search that cannot step over the first root.
//!
//! The search goes by the lower-bounding parabola: with |g̈| ≤ M,
//! g(u + d) ≥ g + ġ·d − M·d²/2, so no root lies before
//! d = (ġ + √(ġ² + 2M·g))/M. Near a simple root this is Newton's step, so it
//! converges quadratically, and always from the same side.

use super::{Locate, SlipPath, StickPath};
use crate::phase::Sense;
use crate::propagate::Propagate;
use crate::real::Real;

/// Both events located.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactEvents;

/// The most trial points of one search. Five or six find a match of ordinary
/// slope; a near miss halves its distance with each, so this reaches rounding
/// in f64 as well.
const SEARCH_STEPS: u32 = 64;

impl<F: Real> Locate<F> for ExactEvents {
    fn break_time(path: &StickPath<F>, sense: Sense, limit_nm: F, length_s: F) -> Option<F> {
        let left = limit_nm - sense.of_signed(path.torque_nm);
        let rate = sense.of_signed(path.rate);
        let curvature = sense.of_signed(path.curvature);
        let time_s = if left > F::ZERO {
            if rate <= F::ZERO && curvature <= F::ZERO {
                return None;
            }
            if curvature == F::ZERO {
                return Some(left / rate).filter(|u| *u <= length_s);
            }
            // Smallest u > 0 with rate·u + curvature·u²/2 = left, without
            // cancellation.
            let square = rate * rate + F::TWO * curvature * left;
            if square < F::ZERO {
                return None;
            }
            let denominator = rate + square.sqrt();
            if denominator <= F::ZERO {
                return None;
            }
            F::TWO * left / denominator
        } else if left < -(F::LIMIT_SLACK * limit_nm) || rate > F::ZERO {
            F::ZERO
        } else if curvature > F::ZERO {
            // At the limit, first inwards and then out again.
            -(F::TWO * rate) / curvature
        } else {
            return None;
        };
        (time_s <= length_s).then_some(time_s)
    }

    fn match_time<P: Propagate<F>>(slip: &SlipPath<'_, F, P>, length_s: F, v_end: F) -> Option<F> {
        let start = slip.overtaking(F::ZERO, slip.v);
        let end = slip.overtaking(length_s, v_end);
        let bound = slip.oscillator.jerk_bound(slip.x, slip.v);
        // A curve that bends by less than `bound` dips below its chord by at
        // most bound·h²/8.
        let dip = bound * length_s * length_s * F::from_f64(0.125);
        if start > dip && end > dip {
            return None;
        }
        search(slip, length_s, bound)
    }
}

/// The first root of g(u) = s·(Ω(u) − v(u)) in [0, `length_s`], where |g̈| ≤
/// `bound`.
fn search<F: Real, P: Propagate<F>>(slip: &SlipPath<'_, F, P>, length_s: F, bound: F) -> Option<F> {
    let rounding = F::TWO * F::TWO * F::EPSILON;
    let mut time_s = F::ZERO;
    let (mut x, mut v) = (slip.x, slip.v);
    for _ in 0..SEARCH_STEPS {
        let gained = slip.omega_dot * time_s;
        let omega = slip.omega + gained;
        let v_dot = slip.oscillator.acceleration(x, v);
        let g = slip.sense.of_signed(omega - v).at_least(F::ZERO);
        let g_dot = slip.sense.of_signed(slip.omega_dot - v_dot);
        // Ω may be the small difference of two large numbers.
        let size = slip.omega.abs() + gained.abs() + slip.oscillator.speed_bound(x, v);
        let noise = rounding * size;
        let advance = if g <= noise {
            if g_dot.abs() <= rounding * (slip.omega_dot.abs() + v_dot.abs()) {
                // A touch: the velocities meet without crossing. Leave it, if
                // they part again: g ≥ g̈·d²/2 − |g⃛|·d³/6 stays above zero up
                // to d = 3·g̈/|g⃛|.
                let parting = slip
                    .sense
                    .of_signed(-slip.oscillator.acceleration(v, v_dot));
                if parting <= F::ZERO {
                    return Some(time_s);
                }
                F::from_f64(3.0) * parting / slip.oscillator.snap_bound(x, v)
            } else if g_dot < F::ZERO {
                // What rounding hides of the way is a straight line.
                return Some((time_s - g / g_dot).at_most(length_s));
            } else {
                // A slip that has just begun.
                F::TWO * g_dot / bound
            }
        } else {
            let root = (g_dot * g_dot + F::TWO * bound * g).sqrt();
            if g_dot > F::ZERO {
                (g_dot + root) / bound
            } else {
                F::TWO * g / (root - g_dot)
            }
        };
        time_s += advance;
        if time_s < length_s {
            (x, v) = slip.propagator.part(slip.x, slip.v, time_s);
        } else {
            return None;
        }
    }
    None
}

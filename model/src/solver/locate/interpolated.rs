//! Both events by one linear interpolation between the ends of the step: one
//! division an event.
//!
//! The error of an event is of second order in the step, and that of the
//! cycle's length higher, since the chord's error at the match is nearly the
//! same in every cycle. An excursion within one step is not seen.

use super::{Locate, SlipPath, StickPath};
use crate::joint::Sense;
use crate::joint::shaft::Linear;
use crate::real::Real;
use crate::solver::propagate::Propagate;

/// Both events interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interpolated;

impl<F: Real> Locate<F> for Interpolated {
    type Shape = Linear;

    #[inline]
    fn break_time(path: &StickPath<F>, sense: Sense, limit_nm: F, length_s: F) -> Option<F> {
        let start = limit_nm - sense.of_signed(path.torque_nm);
        let end = limit_nm - sense.of_signed(path.at(length_s));
        crossing(start, end, length_s)
    }

    #[inline]
    fn match_time<P: Propagate<F>>(slip: &SlipPath<'_, F, P>, length_s: F, v_end: F) -> Option<F> {
        if !slip.has_met(length_s, v_end) {
            return None;
        }
        let start = slip.overtaking(F::ZERO, slip.v);
        if start > F::ZERO {
            crossing(start, slip.overtaking(length_s, v_end), length_s).or(Some(length_s))
        } else {
            // A slip that begins and ends in this step: a chord cannot locate it.
            Some(length_s)
        }
    }
}

/// Zero crossing of the chord from `start` to `end` < 0; 0 if `start` is below.
#[inline]
fn crossing<F: Real>(start: F, end: F, length_s: F) -> Option<F> {
    if end >= F::ZERO {
        return None;
    }
    if start <= F::ZERO {
        return Some(F::ZERO);
    }
    Some((length_s * (start / (start - end))).at_most(length_s))
}

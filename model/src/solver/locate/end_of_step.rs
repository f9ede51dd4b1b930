//! No location: a phase ends at the end of the step in which its condition is
//! first seen. The error of each event is up to one step, so every method
//! built on this is of first order.

use super::{Locate, SlipPath, StickPath};
use crate::joint::Sense;
use crate::joint::shaft::Linear;
use crate::real::Real;
use crate::solver::propagate::Propagate;

/// Switching at the end of the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndOfStep;

impl<F: Real> Locate<F> for EndOfStep {
    type Shape = Linear;

    #[inline]
    fn break_time(path: &StickPath<F>, sense: Sense, limit_nm: F, length_s: F) -> Option<F> {
        (sense.of_signed(path.at(length_s)) > limit_nm).then_some(length_s)
    }

    #[inline]
    fn match_time<P: Propagate<F>>(slip: &SlipPath<'_, F, P>, length_s: F, v_end: F) -> Option<F> {
        slip.has_met(length_s, v_end).then_some(length_s)
    }
}

//! Location of the break alone, as the root of its parabola; a slip ends at the
//! end of the step in which the velocities have met.
//!
//! The match needs no more for second order: it is a smooth contact, v = Ω on
//! both sides, so its error enters the next break only squared.

use super::{EndOfStep, ExactEvents, Locate, SlipPath, StickPath};
use crate::joint::Sense;
use crate::joint::shaft::Linear;
use crate::real::Real;
use crate::solver::propagate::Propagate;

/// The break located, the match not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactBreak;

impl<F: Real> Locate<F> for ExactBreak {
    type Shape = Linear;

    #[inline]
    fn break_time(path: &StickPath<F>, sense: Sense, limit_nm: F, length_s: F) -> Option<F> {
        ExactEvents::break_time(path, sense, limit_nm, length_s)
    }

    #[inline]
    fn match_time<P: Propagate<F>>(slip: &SlipPath<'_, F, P>, length_s: F, v_end: F) -> Option<F> {
        EndOfStep::match_time(slip, length_s, v_end)
    }
}

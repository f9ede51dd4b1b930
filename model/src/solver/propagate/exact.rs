//! The exact propagator: no error but rounding, four multiplications a step.

use super::Propagate;
use crate::joint::StepCoefficients;
use crate::joint::oscillator::{Oscillator, Transition};
use crate::real::Real;

/// Exact free motion: see [`crate::joint::oscillator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact<F> {
    oscillator: Oscillator<F>,
    whole_step: Transition<F>,
}

impl<F: Real> Propagate<F> for Exact<F> {
    fn new(coefficients: &StepCoefficients<F>) -> Self {
        Self {
            oscillator: coefficients.oscillator,
            whole_step: coefficients.oscillator.transition(coefficients.step_s),
        }
    }

    #[inline]
    fn step(&self, x: F, v: F) -> (F, F) {
        self.whole_step.apply(x, v)
    }

    const IS_LINEAR: bool = true;

    #[inline]
    fn whole_step(&self) -> Option<&Transition<F>> {
        Some(&self.whole_step)
    }

    #[inline]
    fn part(&self, x: F, v: F, time_s: F) -> (F, F) {
        self.oscillator.moved(x, v, time_s)
    }
}

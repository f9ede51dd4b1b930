//! Explicit Euler: x⁺ = x + h·v, v⁺ = v + h·f(x, v). First order, and it adds
//! energy: numerical damping of −ωn·h/2.

use super::Propagate;
use crate::joint::StepCoefficients;
use crate::joint::oscillator::Oscillator;
use crate::real::Real;

/// Explicit Euler steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Euler<F> {
    oscillator: Oscillator<F>,
    step_s: F,
}

impl<F: Real> Propagate<F> for Euler<F> {
    fn new(coefficients: &StepCoefficients<F>) -> Self {
        Self {
            oscillator: coefficients.oscillator,
            step_s: coefficients.step_s,
        }
    }

    #[inline]
    fn step(&self, x: F, v: F) -> (F, F) {
        self.part(x, v, self.step_s)
    }

    #[inline]
    fn part(&self, x: F, v: F, time_s: F) -> (F, F) {
        let a = self.oscillator.acceleration(x, v);
        (x + time_s * v, v + time_s * a)
    }
}

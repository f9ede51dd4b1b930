//! Semi-implicit (symplectic) Euler: v⁺ = v + h·f(x, v), x⁺ = x + h·v⁺. First
//! order, but it keeps the energy of an undamped swing on average.

use super::Propagate;
use crate::joint::StepCoefficients;
use crate::joint::oscillator::Oscillator;
use crate::real::Real;

/// Semi-implicit Euler steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SemiImplicitEuler<F> {
    oscillator: Oscillator<F>,
    step_s: F,
}

impl<F: Real> Propagate<F> for SemiImplicitEuler<F> {
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
        let v = v + time_s * self.oscillator.acceleration(x, v);
        (x + time_s * v, v)
    }
}

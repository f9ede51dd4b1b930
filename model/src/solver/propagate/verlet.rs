//! Velocity Verlet (Störmer 1907, Verlet 1967): half a kick, a drift, half a
//! kick. Second order and symplectic without damping; with damping the second
//! kick sees the velocity of the half step.

use super::Propagate;
use crate::joint::StepCoefficients;
use crate::joint::oscillator::Oscillator;
use crate::real::Real;

/// Velocity Verlet steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verlet<F> {
    oscillator: Oscillator<F>,
    step_s: F,
}

impl<F: Real> Propagate<F> for Verlet<F> {
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
        let half = F::HALF * time_s;
        let v_half = v + half * self.oscillator.acceleration(x, v);
        let x = x + time_s * v_half;
        (x, v_half + half * self.oscillator.acceleration(x, v_half))
    }
}

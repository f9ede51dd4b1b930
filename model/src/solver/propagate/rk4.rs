//! The classical Runge-Kutta method of fourth order (Kutta 1901).

use super::Propagate;
use crate::joint::StepCoefficients;
use crate::joint::oscillator::Oscillator;
use crate::real::Real;

/// Runge-Kutta steps of fourth order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rk4<F> {
    oscillator: Oscillator<F>,
    step_s: F,
}

impl<F: Real> Propagate<F> for Rk4<F> {
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

    fn part(&self, x: F, v: F, time_s: F) -> (F, F) {
        let f = |x, v| self.oscillator.acceleration(x, v);
        let half = F::HALF * time_s;
        let (x1, v1) = (v, f(x, v));
        let (x2, v2) = (v + half * v1, f(x + half * x1, v + half * v1));
        let (x3, v3) = (v + half * v2, f(x + half * x2, v + half * v2));
        let (x4, v4) = (v + time_s * v3, f(x + time_s * x3, v + time_s * v3));
        let sixth = time_s * F::from_f64(1.0 / 6.0);
        (
            x + sixth * (x1 + F::TWO * (x2 + x3) + x4),
            v + sixth * (v1 + F::TWO * (v2 + v3) + v4),
        )
    }
}

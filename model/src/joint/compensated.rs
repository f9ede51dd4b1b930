//! A running sum that does not drift.

use crate::real::Real;

/// A sum that carries its last rounding error into the next addition (Kahan's
/// sum, with Knuth's TwoSum). Many small steps in f32 lose no more than one
/// rounding of the total, so a stick that lasts minutes stays where the shaft
/// is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compensated<F> {
    sum: F,
    error: F,
}

impl<F: Real> Compensated<F> {
    /// Starts at `x`.
    #[inline]
    pub fn new(x: F) -> Self {
        Self {
            sum: x,
            error: F::ZERO,
        }
    }

    /// Adds `x`.
    #[inline]
    pub fn add(&mut self, x: F) {
        let x = x + self.error;
        let sum = self.sum + x;
        let x_part = sum - self.sum;
        self.error = (self.sum - (sum - x_part)) + (x - x_part);
        self.sum = sum;
    }

    /// The total.
    #[inline]
    pub fn value(&self) -> F {
        self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_small_steps_do_not_drift() {
        let mut total = Compensated::new(0.0_f32);
        let mut plain = 0.0_f32;
        for _ in 0..1_000_000 {
            total.add(1.37e-9);
            plain += 1.37e-9;
        }
        assert!((total.value() - 1.37e-3).abs() < 2e-10, "{}", total.value());
        assert!(
            (plain - 1.37e-3).abs() > 1e-8,
            "the plain sum drifts: {plain}"
        );
    }

    #[test]
    fn there_and_back_is_where_it_was() {
        let mut total = Compensated::new(1e-3_f32);
        for i in 0..10_000_u16 {
            let x = f32::from(i) * 1.1e-9;
            total.add(x);
            total.add(-x);
        }
        assert_eq!(total.value(), 1e-3);
    }
}

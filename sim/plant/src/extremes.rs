//! Lowest and highest of a series of numbers.

use crepitus_model::Real;

/// Lowest and highest of the numbers so far.
///
/// NaN is ignored. Of two equal numbers the first stays, so that the sign of a zero is the same on
/// every target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes<F> {
    /// Lowest; ∞ without a number.
    pub low: F,
    /// Highest; −∞ without a number.
    pub high: F,
}

impl<F: Real> Default for Extremes<F> {
    fn default() -> Self {
        Self {
            low: F::from_f64(f64::INFINITY),
            high: F::from_f64(f64::NEG_INFINITY),
        }
    }
}

impl<F: Real> Extremes<F> {
    /// Adds a number.
    #[inline]
    pub fn add(&mut self, x: F) {
        self.join(Self { low: x, high: x });
    }

    /// Adds the numbers of other extremes.
    #[inline]
    pub fn join(&mut self, other: Self) {
        self.low = self.low.at_most(other.low);
        self.high = self.high.at_least(other.high);
    }

    /// Returns whether there was no number.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.low > self.high
    }

    /// Distance from the lowest to the highest; −∞ without a number.
    #[inline]
    pub fn width(&self) -> F {
        self.high - self.low
    }
}

impl<F: Real> FromIterator<F> for Extremes<F> {
    fn from_iter<I: IntoIterator<Item = F>>(numbers: I) -> Self {
        let mut extremes = Self::default();
        for x in numbers {
            extremes.add(x);
        }
        extremes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extremes<F: Real>() {
        let f = F::from_f64;
        let of = |numbers: [f64; 3]| numbers.into_iter().map(f).collect::<Extremes<F>>();
        let none = Extremes::<F>::default();
        assert!(none.is_empty() && none.width() == f(f64::NEG_INFINITY));
        assert_eq!(of([f64::NAN; 3]), none);
        let some = of([1.0, f64::NAN, -2.0]);
        assert_eq!((some.low, some.high), (f(-2.0), F::ONE));
        assert!(!some.is_empty());
        assert_eq!(some.width(), f(3.0));
        let one = of([0.5; 3]);
        assert!(!one.is_empty() && one.width() == F::ZERO);
        let mut all = none;
        for part in [none, of([1.0, 2.0, 3.0]), some, none] {
            all.join(part);
        }
        assert_eq!((all.low, all.high), (f(-2.0), f(3.0)));
        // Of two zeros the first.
        for zero in [0.0_f64, -0.0] {
            let zeros = of([zero, -zero, -zero]);
            for end in [zeros.low, zeros.high] {
                assert_eq!(end.to_f64().to_bits(), zero.to_bits());
            }
        }
    }

    #[test]
    fn lowest_and_highest_of_numbers_in_both_precisions() {
        extremes::<f32>();
        extremes::<f64>();
    }
}

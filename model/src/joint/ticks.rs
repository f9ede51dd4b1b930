//! Time on the device: whole ticks plus a fraction inside the tick.
//!
//! A clock that adds up seconds in f32 stands still after 17 minutes; a count
//! of ticks does not, and the fraction inside one tick needs no more than f32.

use crate::real::Real;

/// A length of time: `whole` ticks and `fraction` in [0, 1) of one more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ticks<F> {
    /// Whole ticks.
    pub whole: u64,
    /// Part of a tick, in [0, 1).
    pub fraction: F,
}

impl<F: Real> Ticks<F> {
    /// Length of a number of ticks; negative and NaN give zero.
    #[inline]
    pub fn new(ticks: F) -> Self {
        let whole = ticks.whole();
        Self {
            whole,
            // Zero first, so that NaN becomes zero.
            fraction: F::ZERO.at_least(ticks - F::from_whole(whole)),
        }
    }

    /// Length of a number of ticks in f64, so that a long span keeps a precise
    /// fraction in f32 too.
    pub fn from_f64(ticks: f64) -> Self {
        let Ticks { whole, fraction } = Ticks::<f64>::new(ticks);
        Self {
            whole,
            fraction: F::from_f64(fraction),
        }
        .carried()
    }

    /// Later by a part of a tick, in [0, 1].
    #[inline]
    #[must_use]
    pub fn later_by(self, fraction: F) -> Self {
        Self {
            whole: self.whole,
            fraction: self.fraction + fraction,
        }
        .carried()
    }

    /// Shorter by `other`; not below zero.
    #[inline]
    #[must_use]
    pub fn less(self, other: Self) -> Self {
        let fraction = self.fraction - other.fraction;
        let (borrow, fraction) = if fraction < F::ZERO {
            (1, fraction + F::ONE)
        } else {
            (0, fraction)
        };
        match self.whole.checked_sub(other.whole) {
            Some(whole) if whole >= borrow => Self {
                whole: whole - borrow,
                fraction,
            }
            .carried(),
            _ => Self::default(),
        }
    }

    /// This time in ticks of another length, `ratio` of them in one of these; computed in f64.
    #[must_use]
    pub fn stretched(self, ratio: f64) -> Self {
        let ticks = f64::from_whole(self.whole) + self.fraction.to_f64();
        Self::from_f64(ticks * ratio)
    }

    /// The length in ticks as one number.
    #[inline]
    pub fn value(self) -> F {
        F::from_whole(self.whole) + self.fraction
    }

    /// Brings a fraction in [0, 2) back below one.
    #[inline]
    fn carried(self) -> Self {
        if self.fraction >= F::ONE {
            Self {
                whole: self.whole.saturating_add(1),
                fraction: self.fraction - F::ONE,
            }
        } else {
            self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_differences_carry() {
        let t = Ticks::<f32>::from_f64(628.75);
        assert_eq!((t.whole, t.fraction), (628, 0.75));
        assert_eq!(
            t.later_by(0.5),
            Ticks {
                whole: 629,
                fraction: 0.25
            }
        );
        assert_eq!(
            t.less(Ticks {
                whole: 20,
                fraction: 0.875
            }),
            Ticks {
                whole: 607,
                fraction: 0.875
            }
        );
        assert_eq!(
            t.less(Ticks {
                whole: 700,
                fraction: 0.0
            }),
            Ticks::default()
        );
        assert_eq!(Ticks::new(f32::NAN), Ticks::default());
        assert_eq!(Ticks::new(-3.0_f64), Ticks::default());
    }

    #[test]
    fn a_long_span_keeps_its_fraction_in_single_precision() {
        let t = Ticks::<f32>::from_f64(40_000_000.3);
        assert_eq!(t.whole, 40_000_000);
        assert!((t.fraction - 0.3).abs() < 1e-6);
    }
}

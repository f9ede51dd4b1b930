//! A value with its interval.

/// Standard deviations to either side that hold 95 % of a normal distribution.
pub(crate) const DEVIATIONS: f64 = 1.959_964;

/// A value and the half width of its 95 % interval, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The most likely value.
    pub value: f64,
    /// The truth is within ± this in 95 of 100 cases.
    pub half_width: f64,
}

impl Estimate {
    /// A value known to ± a share of it.
    pub(crate) fn known(value: f64, share: f64) -> Self {
        Self {
            value,
            half_width: (value * share).abs(),
        }
    }

    /// The half width as a share of the value.
    pub fn share(&self) -> f64 {
        (self.half_width / self.value).abs()
    }

    /// Whether a value lies in the interval.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half_width
    }

    /// Both times a factor: another unit.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            half_width: self.half_width * factor.abs(),
        }
    }
}

//! Value with a 95 % confidence interval.

/// Standard deviations to either side that hold 95 % of a normal distribution.
pub const DEVIATIONS: f64 = 1.959_963_984_540_054;

/// A value and the half width of its 95 % confidence interval, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Estimated value.
    pub value: f64,
    /// Half width of the 95 % confidence interval.
    pub half_width: f64,
}

impl Estimate {
    /// Returns a value with a half width that is a share of it.
    pub(crate) fn known(value: f64, share: f64) -> Self {
        Self {
            value,
            half_width: (value * share).abs(),
        }
    }

    /// Returns the half width as a share of the value.
    pub fn share(&self) -> f64 {
        (self.half_width / self.value).abs()
    }

    /// Returns whether a value lies in the interval.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half_width
    }

    /// Formats value and half width, to the second digit of the half width.
    pub fn rounded(&self) -> (String, String) {
        let place = self.half_width.abs().log10().floor();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 9"
        )]
        let decimals = (1.0 - place).clamp(0.0, 9.0) as usize;
        (
            format!("{:.decimals$}", self.value),
            format!("{:.decimals$}", self.half_width),
        )
    }

    /// Multiplies value and half width by a factor, to convert the unit.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            half_width: self.half_width * factor.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_that_are_known() {
        let rounded = |value, half_width| Estimate { value, half_width }.rounded();
        let text = |value: &str, half_width: &str| (value.to_owned(), half_width.to_owned());
        assert_eq!(rounded(94.915_34, 2.622_43), text("94.9", "2.6"));
        assert_eq!(rounded(0.438_57, 0.001_33), text("0.4386", "0.0013"));
        assert_eq!(rounded(1234.5, 67.0), text("1234", "67"));
        assert_eq!(rounded(1.0, 0.0), text("1.000000000", "0.000000000"));
    }
}

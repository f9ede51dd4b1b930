//! A Taylor polynomial with a bound of its remainder.
//!
//! ```text
//! f(t₀ + h·σ) = Σ cₖ·σᵏ + r(σ),   |r(σ)| ≤ error,   0 ≤ σ ≤ 1
//! ```
//! The coefficients include the power of the length h, so that they have one
//! unit and their sizes are those of the terms.

use crate::double_double::Dd;
use std::sync::LazyLock;

/// The most coefficients of a series: degree 34, and one for its remainder.
pub const MOST: usize = 36;

/// 1/k for k = 1 to the number of coefficients and one more.
static RECIPROCALS: LazyLock<[Dd; MOST + 2]> = LazyLock::new(|| {
    let mut k = 0.0;
    [(); MOST + 2].map(|()| {
        let reciprocal = if k > 0.0 {
            Dd::ONE / Dd::new(k)
        } else {
            Dd::ZERO
        };
        k += 1.0;
        reciprocal
    })
});

/// 1/k, for 1 ≤ k ≤ [`MOST`] + 1.
#[inline]
pub fn reciprocal(k: usize) -> Dd {
    RECIPROCALS[k]
}

/// The index of a coefficient as a number.
#[inline]
#[expect(clippy::cast_precision_loss, reason = "below MOST")]
pub fn number(k: usize) -> f64 {
    k as f64
}

/// A polynomial in σ on [0, 1] and the bound of its remainder.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    coefficients: [Dd; MOST],
    len: usize,
    /// A bound of the remainder on [0, 1].
    pub error: f64,
}

impl Series {
    /// A constant.
    pub fn constant(c: Dd) -> Self {
        let mut coefficients = [Dd::ZERO; MOST];
        coefficients[0] = c;
        Self {
            coefficients,
            len: 1,
            error: 0.0,
        }
    }

    /// The series with these coefficients; at most [`MOST`] count.
    pub fn of(given: &[Dd], error: f64) -> Self {
        let len = given.len().min(MOST);
        let mut coefficients = [Dd::ZERO; MOST];
        coefficients[..len].copy_from_slice(&given[..len]);
        Self {
            coefficients,
            len,
            error,
        }
    }

    /// The coefficients.
    pub fn coefficients(&self) -> &[Dd] {
        &self.coefficients[..self.len]
    }

    /// a·self + b·other.
    pub fn combine(&self, a: Dd, other: &Self, b: Dd) -> Self {
        let mut result = Self::constant(Dd::ZERO);
        result.len = self.len.max(other.len);
        for (k, c) in result.coefficients[..result.len].iter_mut().enumerate() {
            // Beyond its length a series holds zeros.
            *c = match (k < self.len, k < other.len) {
                (true, true) => a * self.coefficients[k] + b * other.coefficients[k],
                (true, false) => a * self.coefficients[k],
                _ => b * other.coefficients[k],
            };
        }
        result.error = a.to_f64().abs() * self.error + b.to_f64().abs() * other.error;
        result
    }

    /// The series and a constant.
    pub fn plus(mut self, constant: Dd) -> Self {
        self.coefficients[0] += constant;
        self
    }

    /// c·self.
    pub fn times(mut self, c: Dd) -> Self {
        for coefficient in &mut self.coefficients[..self.len] {
            *coefficient = c * *coefficient;
        }
        self.error *= c.to_f64().abs();
        self
    }

    /// The derivative by time, where σ = 1 is a length of `1/per_s`; `error`
    /// bounds what the derivative leaves out.
    pub fn derivative(&self, per_s: Dd, error: f64) -> Self {
        let mut result = Self::constant(Dd::ZERO);
        result.len = self.len.saturating_sub(1).max(1);
        for k in 1..self.len {
            result.coefficients[k - 1] = self.coefficients[k] * number(k) * per_s;
        }
        result.error = error;
        result
    }

    /// The quotient by σⁿ, whose first n coefficients are taken to be 0.
    pub fn without_leading(&self, n: usize) -> Self {
        let mut rest = Self::of(&self.coefficients[n.min(self.len)..self.len], self.error);
        rest.len = rest.len.max(1);
        rest
    }

    /// This series with its coefficient of σᵏ replaced.
    pub fn with(mut self, k: usize, c: Dd) -> Self {
        self.coefficients[k] = c;
        self.len = self.len.max(k + 1);
        self
    }

    /// The value at σ.
    pub fn value(&self, at: Dd) -> Dd {
        let mut sum = Dd::ZERO;
        for &c in self.coefficients().iter().rev() {
            sum = sum * at + c;
        }
        sum
    }

    /// The value at the end, σ = 1.
    pub fn end(&self) -> Dd {
        let mut sum = Dd::ZERO;
        for &c in self.coefficients().iter().rev() {
            sum += c;
        }
        sum
    }

    /// The derivative by σ at σ.
    pub fn slope(&self, at: Dd) -> Dd {
        let mut sum = Dd::ZERO;
        for (k, &c) in self.coefficients().iter().enumerate().skip(1).rev() {
            sum = sum * at + c * number(k);
        }
        sum
    }

    /// Σ|cₖ|, which bounds the polynomial on [0, 1].
    pub fn size(&self) -> f64 {
        self.coefficients().iter().map(|c| c.to_f64().abs()).sum()
    }
}

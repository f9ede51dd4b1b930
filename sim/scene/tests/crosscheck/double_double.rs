//! Numbers of about 31 digits: the unevaluated sum of two f64.
//!
//! ```text
//! x = hi + lo,  |lo| ≤ ulp(hi)/2
//! ```
//! The basic operations are the classical error-free transformations: Knuth's
//! two-sum and Dekker's two-product by splitting, which need no fused
//! multiply-add and give the same bits on every machine. Relative errors are
//! below 2⁻¹⁰² for sums and products, 2⁻¹⁰⁰ for quotients and roots.
//!
//! Sources: Dekker, "A floating-point technique for extending the available
//! precision", Numer. Math. 18 (1971); Joldes, Muller, Popescu, "Tight and
//! rigorous error bounds for basic building blocks of double-word
//! arithmetic", ACM TOMS 44 (2017).

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A number of about 31 digits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dd {
    hi: f64,
    lo: f64,
}

/// The sum and its rounding error.
#[inline]
fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let b_part = hi - a;
    let a_part = hi - b_part;
    Dd {
        hi,
        lo: (a - a_part) + (b - b_part),
    }
}

/// The sum and its rounding error where |a| ≥ |b|.
#[inline]
fn quick_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd {
        hi,
        lo: b - (hi - a),
    }
}

/// A number as two of at most 26 bits each.
#[inline]
fn split(a: f64) -> (f64, f64) {
    /// 2²⁷ + 1.
    const SPLITTER: f64 = 134_217_729.0;
    let t = SPLITTER * a;
    let high = t - (t - a);
    (high, a - high)
}

/// The product and its rounding error.
#[inline]
fn two_product(a: f64, b: f64) -> Dd {
    let hi = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    Dd {
        hi,
        lo: ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2,
    }
}

impl Dd {
    /// 0.
    pub const ZERO: Self = Self::new(0.0);
    /// 1.
    pub const ONE: Self = Self::new(1.0);
    /// π to 32 digits.
    pub const PI: Self = Self {
        hi: std::f64::consts::PI,
        lo: 1.224_646_799_147_353_2e-16,
    };

    /// An f64 as it is.
    #[inline]
    pub const fn new(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    /// The nearest f64.
    #[inline]
    pub const fn to_f64(self) -> f64 {
        self.hi
    }

    /// |x|.
    #[inline]
    pub fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// The product with a power of two, exact.
    #[inline]
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self {
            hi: self.hi * power_of_two,
            lo: self.lo * power_of_two,
        }
    }

    /// √x; 0 for what is not positive.
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ZERO;
        }
        // Two of Newton's steps from the root of the leading part.
        let mut root = Self::new(self.hi.sqrt());
        for _ in 0..2 {
            root = (root + self / root).scaled(0.5);
        }
        root
    }

    /// −1, 0 or 1.
    #[inline]
    pub fn sign(self) -> f64 {
        if self.hi > 0.0 {
            1.0
        } else if self.hi < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    /// The smaller of two.
    #[inline]
    pub fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
}

impl From<f64> for Dd {
    #[inline]
    fn from(x: f64) -> Self {
        Self::new(x)
    }
}

impl PartialOrd for Dd {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&other.lo),
            order => order,
        }
    }
}

impl Neg for Dd {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Add for Dd {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let v = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(v.hi, t.lo + v.lo)
    }
}

impl AddAssign for Dd {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Dd {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Add::add(self, -other)
    }
}

impl Mul for Dd {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let p = two_product(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Mul<f64> for Dd {
    type Output = Self;
    #[inline]
    fn mul(self, other: f64) -> Self {
        let p = two_product(self.hi, other);
        quick_two_sum(p.hi, p.lo + self.lo * other)
    }
}

impl Div for Dd {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        // Long division, three digits of 53 bits.
        let q1 = self.hi / other.hi;
        let r = self - other * q1;
        let q2 = r.hi / other.hi;
        let r = r - other * q2;
        let q = quick_two_sum(q1, q2);
        q + Self::new(r.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_has_31_digits() {
        let third = Dd::ONE / Dd::new(3.0);
        let error = third * 3.0 - Dd::ONE;
        assert!(error.abs().to_f64() < 1e-31, "{error:?}");
    }

    #[test]
    fn operations_undo_each_other_over_many_magnitudes() {
        let mut rng = fastrand::Rng::with_seed(1);
        for _ in 0..20_000 {
            let mut any = || {
                let wide = 10.0_f64.powf(rng.f64() * 40.0 - 20.0);
                Dd::new(wide) + Dd::new(wide * 1e-17 * (rng.f64() - 0.5))
            };
            let (a, b) = (any(), any());
            let relative = |x: Dd, y: Dd| ((x - y) / y).abs().to_f64();
            assert!(relative(a * b / b, a) < 1e-30);
            assert!(relative(a.sqrt() * a.sqrt(), a) < 1e-30);
            // (a + b)² = a² + 2ab + b²
            let sum = a + b;
            assert!(relative(a * a + (a * b).scaled(2.0) + b * b, sum * sum) < 1e-30);
            assert!(((a + b) - b - a).abs().to_f64() <= 1e-31 * sum.to_f64());
        }
    }

    #[test]
    fn what_f64_loses_is_kept() {
        let x = Dd::ONE + Dd::new(1e-25);
        assert_eq!((x - Dd::ONE).to_f64(), 1e-25);
        assert!(x > Dd::ONE);
        assert!(-x < x);
    }
}

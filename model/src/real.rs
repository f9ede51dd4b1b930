//! The numbers the model computes with: f32 on the device, f64 on the host.
//!
//! [`Real`] holds just the operations that the model uses. They are the same
//! instructions on every target: no fused multiply-add, no platform `sinf`.
//! For f64 the elementary functions are those of the pure-Rust `libm`. For f32
//! they are the short polynomials of [`single`], because `libm`'s f32 sine
//! computes in f64, which a Cortex-M4F does in software.

#[cfg(test)]
pub(crate) mod counted;
mod double;
pub mod single;
mod square_root;
mod straight;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A state that only a simulator needs, which computes in f64: in f32, the device's precision, it takes
/// no memory, and what is done with it is left out.
pub trait InDouble<T>: Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// The state, if there is one.
    fn get(&mut self) -> Option<&mut T>;
}

/// A state that is there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct There<T>(T);

impl<T: State> InDouble<T> for There<T> {
    #[inline]
    fn get(&mut self) -> Option<&mut T> {
        Some(&mut self.0)
    }
}

impl<T> InDouble<T> for () {
    #[inline]
    fn get(&mut self) -> Option<&mut T> {
        None
    }
}

/// Type that a state of [`InDouble`] can have.
pub trait State: Copy + Debug + Default + PartialEq + Send + Sync + 'static {}

impl<T: Copy + Debug + Default + PartialEq + Send + Sync + 'static> State for T {}

/// A floating-point type that the model can run in.
///
/// Implemented for `f32` and `f64`; the trait is sealed by what it is for,
/// not by type: a third precision would be one more file beside these two.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + SubAssign
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1/2.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Relative slack of the static limit: a required torque that little
    /// beyond it counts as *at* the limit, see
    /// [`StepCoefficients::limit_slack_nm`](crate::StepCoefficients::limit_slack_nm).
    ///
    /// Some parameter sets re-stick exactly on the limit (Tk = 0 ends every
    /// slip at −Ts), where rounding decides which side one sees. The slack is
    /// far above the rounding of one cycle and far below what a hand can feel.
    const LIMIT_SLACK: Self;
    /// Relative slack of a touch. With Ts = Tk the velocities meet without
    /// crossing, and such a time is known to the root of the rounding only:
    /// see [`StepCoefficients::touch_slack_nm`](crate::StepCoefficients::touch_slack_nm).
    const TOUCH_SLACK: Self;
    /// Magnitude below which a number is at rest. Far below anything that matters, and
    /// far above the subnormal numbers that a decay would otherwise end in,
    /// which some processors compute with slowly.
    const AT_REST: Self;
    /// A state where this is f64, and nothing where it is f32.
    type InDouble<T: State>: InDouble<T>;
    /// True for f32, whose 24 bits need only short series.
    const IS_SINGLE: bool;
    /// Name in scene files: `f32` or `f64`.
    const NAME: &'static str;

    /// The nearest number to `x`.
    fn from_f64(x: f64) -> Self;
    /// This number as f64 (exact for both precisions).
    fn to_f64(self) -> f64;
    /// The whole part of a non-negative number; negative and NaN give 0, too
    /// large returns `u64::MAX`.
    fn whole(self) -> u64;
    /// The nearest number to a whole one; in f32 beyond 2³² one of the nearest.
    fn from_whole(n: u64) -> Self;

    /// The nearest number to an encoder count.
    fn from_count(n: i32) -> Self;

    /// |x|.
    fn abs(self) -> Self;
    /// √x, correctly rounded.
    fn sqrt(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// (sin x, cos x), x in rad.
    fn sin_cos(self) -> (Self, Self);
    /// (sin x, cos x) without a branch, so that a loop takes several at once, and whether they have the
    /// bits of [`sin_cos`](Self::sin_cos).
    fn straight_sin_cos(self) -> (Self, Self, bool) {
        let (sin, cos) = self.sin_cos();
        (sin, cos, true)
    }
    /// The angle of the point (x, y) with y = `self`, in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// This number, or zero if it is at rest. A NaN stays one.
    #[inline]
    #[must_use]
    fn settled(self) -> Self {
        if self.abs() < Self::AT_REST {
            Self::ZERO
        } else {
            self
        }
    }

    /// The larger of two, and `self` of two that are equal: −0 stays −0. A NaN on the right is
    /// ignored.
    #[inline]
    #[must_use]
    fn at_least(self, low: Self) -> Self {
        if low > self { low } else { self }
    }

    /// The smaller of two, and `self` of two that are equal. A NaN on the right is ignored.
    #[inline]
    #[must_use]
    fn at_most(self, high: Self) -> Self {
        if high < self { high } else { self }
    }

    /// This number, held within ±`limit`; a NaN stays one.
    #[inline]
    #[must_use]
    fn within(self, limit: Self) -> Self {
        self.at_most(limit).at_least(-limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn operations<F: Real>() {
        let f = F::from_f64;
        let (nan, inf) = (f(f64::NAN), f(f64::INFINITY));
        assert!(f(-2.5).is_finite() && !nan.is_finite() && !inf.is_finite());
        assert!(!(-inf).is_finite());
        assert_eq!(f(-2.5).abs(), f(2.5));
        assert_eq!(f(2.5).to_f64(), 2.5);
        for (x, n) in [(7.9, 7), (0.0, 0), (-3.0, 0), (f64::NAN, 0)] {
            assert_eq!(f(x).whole(), n, "{x}");
        }
        assert_eq!(inf.whole(), u64::MAX);
        for n in [0, 20, 1 << 24, u64::from(u32::MAX) + 1, 3 << 40] {
            assert_eq!(F::from_whole(n).whole(), n);
        }
        assert_eq!(F::from_whole(20), f(20.0));
        assert_eq!(F::from_count(-7), f(-7.0));
        assert_eq!((f(9.0).sqrt(), f(0.0).exp()), (f(3.0), F::ONE));
        assert_eq!(F::ZERO.sin_cos(), (F::ZERO, F::ONE));
        assert_eq!(F::ONE.at_least(F::TWO), F::TWO);
        assert_eq!(F::TWO.at_least(F::ONE), F::TWO);
        assert_eq!(F::ONE.at_most(F::TWO), F::ONE);
        assert_eq!(F::TWO.at_most(F::ONE), F::ONE);
        assert_eq!(F::TWO.within(F::ONE), F::ONE);
        assert_eq!((-F::TWO).within(F::ONE), -F::ONE);
        assert_eq!(F::HALF.within(F::ONE), F::HALF);
        assert!(nan.within(F::ONE) != nan.within(F::ONE));
        // A NaN on the right is ignored.
        assert_eq!(
            (F::ONE.at_least(nan), F::ONE.at_most(nan)),
            (F::ONE, F::ONE)
        );
        // Of two zeros the left one.
        for zero in [0.0_f64, -0.0] {
            let of = |x: F| x.to_f64().to_bits();
            assert_eq!(of(f(zero).at_least(f(-zero))), zero.to_bits());
            assert_eq!(of(f(zero).at_most(f(-zero))), zero.to_bits());
        }
        assert_eq!(F::ONE + F::EPSILON * F::HALF, F::ONE);
        assert!(F::ONE + F::EPSILON > F::ONE);
        assert_eq!((F::AT_REST * F::HALF).settled(), F::ZERO);
        assert_eq!((-F::AT_REST * F::HALF).settled(), F::ZERO);
        assert_eq!((-F::AT_REST).settled(), -F::AT_REST);
        assert!(nan.settled() != nan.settled());
    }

    #[test]
    fn both_precisions_do_what_they_say() {
        operations::<f32>();
        operations::<f64>();
    }

    #[test]
    fn elementary_functions_are_those_of_a_circle() {
        for i in -200..200 {
            let x = f64::from(i) * 0.07;
            let (sin, cos) = Real::sin_cos(x);
            assert!((sin - libm::sin(x)).abs() < 1e-15 && (cos - libm::cos(x)).abs() < 1e-15);
            assert!((Real::exp(x) / libm::exp(x) - 1.0).abs() < 1e-14);
            let angle = Real::atan2(sin, cos);
            assert!((angle - libm::atan2(sin, cos)).abs() < 1e-15);
        }
    }
}

//! f64: the elementary functions of `libm`, the same on every target.

use super::straight::straight_sin_cos;
use super::{Real, State, There};

impl Real for f64 {
    type InDouble<T: State> = There<T>;
    const ZERO: Self = 0.0;
    const HALF: Self = 0.5;
    const ONE: Self = 1.0;
    const TWO: Self = 2.0;
    const EPSILON: Self = f64::EPSILON;
    const LIMIT_SLACK: Self = 1e-9;
    const TOUCH_SLACK: Self = 1e-6;
    const AT_REST: Self = 1e-290;
    const IS_SINGLE: bool = false;
    const NAME: &'static str = "f64";

    #[inline]
    fn from_f64(x: f64) -> Self {
        x
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` truncates and saturates, which is the contract"
    )]
    fn whole(self) -> u64 {
        self as u64
    }

    #[inline]
    #[expect(clippy::cast_precision_loss, reason = "nearest is the contract")]
    fn from_whole(n: u64) -> Self {
        n as f64
    }

    #[inline]
    fn from_count(n: i32) -> Self {
        f64::from(n)
    }

    #[inline]
    fn abs(self) -> Self {
        libm::fabs(self)
    }

    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    #[inline]
    fn exp(self) -> Self {
        libm::exp(self)
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn straight_sin_cos(self) -> (Self, Self, bool) {
        straight_sin_cos(self)
    }

    #[inline]
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }

    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

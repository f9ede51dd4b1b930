//! Quotients with one divisor: exact, or quick.

use crate::real::Real;

/// Divides many numbers by the same one: exactly, or as a product with the reciprocal.
pub(crate) trait Divisor<F> {
    /// Whether everything is rounded as little as possible.
    const IS_EXACT: bool;

    fn new(divisor: F) -> Self;
    fn of(&self, dividend: F) -> F;
}

/// Rounded once.
pub(crate) struct Exact<F>(F);

/// Rounded twice, in one cycle instead of fourteen.
pub(crate) struct Reciprocal<F>(F);

impl<F: Real> Divisor<F> for Exact<F> {
    const IS_EXACT: bool = true;

    fn new(divisor: F) -> Self {
        Self(divisor)
    }

    fn of(&self, dividend: F) -> F {
        dividend / self.0
    }
}

impl<F: Real> Divisor<F> for Reciprocal<F> {
    const IS_EXACT: bool = false;

    fn new(divisor: F) -> Self {
        Self(F::ONE / divisor)
    }

    fn of(&self, dividend: F) -> F {
        dividend * self.0
    }
}

//! Exponential approach to a level, as bristles have it over a travel.
//!
//! ```text
//! T → T + (level − T)·(1 − exp(−y))
//! ```
//!
//! For a small y the difference cancels: in f32 a y below 6·10⁻⁸ would move nothing, and a slow
//! shaft would never load its bristles. There it is a series.

use crepitus_model::Real;

/// Below this y the series is used.
const SMALL: f64 = 0.25;

/// 1 − exp(−y) for y ≥ 0, within a few roundings of its value: 0 at 0, 1 at infinity.
#[inline]
pub(super) fn share<F: Real>(y: F) -> F {
    if y < F::from_f64(SMALL) {
        y * series(y)
    } else {
        F::ONE - (-y).exp()
    }
}

/// (1 − exp(−y))/y for y ≥ 0, the mean of exp(−y) on the way: 1 at 0.
#[inline]
pub(super) fn mean<F: Real>(y: F) -> F {
    if y < F::from_f64(SMALL) {
        series(y)
    } else {
        (F::ONE - (-y).exp()) / y
    }
}

/// 1 − y/2·(1 − y/3·(1 − …)), cut where the next term is below the rounding at [`SMALL`].
#[inline]
fn series<F: Real>(y: F) -> F {
    let term = |rest: F, nth: f64| F::ONE - y * F::from_f64(1.0 / nth) * rest;
    let mut rest = F::ONE;
    if !F::IS_SINGLE {
        rest = term(rest, 12.0);
        rest = term(rest, 11.0);
        rest = term(rest, 10.0);
        rest = term(rest, 9.0);
        rest = term(rest, 8.0);
        rest = term(rest, 7.0);
    }
    rest = term(rest, 6.0);
    rest = term(rest, 5.0);
    rest = term(rest, 4.0);
    rest = term(rest, 3.0);
    term(rest, 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_keeps_its_relative_precision() {
        for exponent in -60..10 {
            for part in [1.0, 1.2, 1.6, 1.999] {
                let y: f64 = part * 2.0_f64.powi(exponent);
                let wanted = -(-y).exp_m1();
                assert!((share(y) / wanted - 1.0).abs() < 2e-15, "{y}");
                assert!((mean(y) * y / wanted - 1.0).abs() < 2e-15, "{y}");
                #[expect(clippy::cast_possible_truncation, reason = "the precision under test")]
                let single = f64::from(share(y as f32));
                assert!((single / wanted - 1.0).abs() < 6e-7, "{y}: {single}");
                #[expect(clippy::cast_possible_truncation, reason = "the precision under test")]
                let single = f64::from(mean(y as f32)) * y;
                assert!((single / wanted - 1.0).abs() < 6e-7, "{y}: {single}");
            }
        }
        assert_eq!((share(0.0_f32), share(f32::INFINITY)), (0.0, 1.0));
        assert_eq!((share(0.0_f64), share(f64::INFINITY)), (0.0, 1.0));
        assert_eq!((mean(0.0_f32), mean(f32::INFINITY)), (1.0, 0.0));
        assert_eq!((mean(0.0_f64), mean(f64::INFINITY)), (1.0, 0.0));
    }
}

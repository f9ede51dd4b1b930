//! f32: short polynomials after a range reduction, for a core with single
//! precision hardware only.
//!
//! Every function is a fixed sequence of additions and multiplications, so the
//! device, the simulator and the host compute the same bits. Odd functions are
//! odd bit for bit, which the mirror symmetry T(−Ω) = −T(Ω) rests on.
//! Coefficients are those of the Taylor series, cut where the next term is
//! below half a unit in the last place over the reduced range.

use super::square_root::square_root;
use super::{Real, State};
use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, LOG2_E, PI};

// π/2 = HI + MID + LO, where HI and MID have so few digits that a product with
// a quotient below 2^12 is exact (Cody and Waite).
const FRAC_PI_2_HI: f32 = 1.570_312_5;
const FRAC_PI_2_MID: f32 = 4.837_513e-4;
const FRAC_PI_2_LO: f32 = 7.549_79e-8;
// ln 2 = HI + LO in the same way.
const LN_2_HI: f32 = 0.693_359_4;
const LN_2_LO: f32 = -2.121_944_4e-4;

/// (sin x, cos x) within 2e-7 for |x| ≤ 6,000 rad; beyond, the sine and cosine of
/// an angle that has lost its phase. NaN for a number that is not finite.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    // Beyond, the phase is lost, but a sine stays one.
    let x = if Real::abs(x) > 6000.0 {
        libm::fmodf(x, core::f32::consts::TAU)
    } else {
        x
    };
    sin_cos_in_range(x)
}

/// [`sin_cos`] for |x| ≤ 6,000 rad, without the loop that reduces what is larger: for an
/// interrupt, whose loops are bounded.
#[inline]
pub fn sin_cos_in_range(x: f32) -> (f32, f32) {
    let (quarter_turns, s, c) = reduced(x);
    match quarter_turns & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// [`sin_cos_in_range`] without a branch.
#[inline(always)]
#[expect(clippy::inline_always, reason = "the target features of its caller")]
fn straight(x: f32) -> (f32, f32) {
    let (quarter_turns, s, c) = reduced(x);
    let turns = quarter_turns.cast_unsigned();
    let (sin, cos) = if turns & 1 == 0 { (s, c) } else { (c, s) };
    let signed = |x: f32, turns: u32| f32::from_bits(x.to_bits() ^ ((turns & 2) << 30));
    (signed(sin, turns), signed(cos, turns.wrapping_add(1)))
}

/// Quarter turns of x, and sine and cosine of the rest.
#[inline(always)]
#[expect(clippy::inline_always, reason = "the target features of its caller")]
fn reduced(x: f32) -> (i32, f32, f32) {
    let quarter_turns = nearest(x * FRAC_2_PI);
    #[expect(clippy::cast_precision_loss, reason = "exact below 2^24")]
    let k = quarter_turns as f32;
    let r = ((x - k * FRAC_PI_2_HI) - k * FRAC_PI_2_MID) - k * FRAC_PI_2_LO;
    let z = r * r;
    let s = r * polynomial(
        z,
        &[1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0],
    );
    let c = polynomial(
        z,
        &[
            1.0,
            -0.5,
            1.0 / 24.0,
            -1.0 / 720.0,
            1.0 / 40_320.0,
            -1.0 / 3_628_800.0,
        ],
    );
    (quarter_turns, s, c)
}

/// eˣ within 2e-7 relative; 0 below −87, infinite above 88.
#[inline]
pub fn exp(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    if x > 88.0 {
        return f32::INFINITY;
    }
    let n = nearest(x * LOG2_E);
    #[expect(clippy::cast_precision_loss, reason = "|n| ≤ 127")]
    let k = n as f32;
    let r = (x - k * LN_2_HI) - k * LN_2_LO;
    let e = polynomial(
        r,
        &[
            1.0,
            1.0,
            0.5,
            1.0 / 6.0,
            1.0 / 24.0,
            1.0 / 120.0,
            1.0 / 720.0,
            1.0 / 5040.0,
        ],
    );
    #[expect(clippy::cast_sign_loss, reason = "−126 ≤ n ≤ 127 here")]
    let power_of_two = f32::from_bits(((n + 127) as u32) << 23);
    e * power_of_two
}

/// The angle of the point (x, y) in (−π, π], within 3e-7.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ax, ay) = (Real::abs(x), Real::abs(y));
    let steep = ay > ax;
    let (low, high) = if steep { (ax, ay) } else { (ay, ax) };
    // 0/0 is the angle of the origin: 0, or π on the negative side.
    let t = if high > 0.0 { low / high } else { 0.0 };
    let first_octant = atan_unit(t);
    let quadrant = if steep {
        FRAC_PI_2 - first_octant
    } else {
        first_octant
    };
    let half = if x < 0.0 { PI - quadrant } else { quadrant };
    if y < 0.0 { -half } else { half }
}

/// atan t for 0 ≤ t ≤ 1: by the half angle above tan(π/8), then a series.
#[inline]
fn atan_unit(t: f32) -> f32 {
    const TAN_PI_8: f32 = 0.414_213_57;
    let (offset, r) = if t > TAN_PI_8 {
        (FRAC_PI_4, (t - 1.0) / (t + 1.0))
    } else {
        (0.0, t)
    };
    let series = polynomial(
        r * r,
        &[
            1.0,
            -1.0 / 3.0,
            1.0 / 5.0,
            -1.0 / 7.0,
            1.0 / 9.0,
            -1.0 / 11.0,
            1.0 / 13.0,
            -1.0 / 15.0,
            1.0 / 17.0,
        ],
    );
    offset + r * series
}

/// Horner's scheme; coefficients from the constant upwards.
#[inline]
fn polynomial<const N: usize>(x: f32, coefficients: &[f32; N]) -> f32 {
    coefficients.iter().rev().fold(0.0, |sum, &c| sum * x + c)
}

/// The nearest whole number, halves away from zero: odd, unlike a floor.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "`as` truncates and saturates"
)]
fn nearest(x: f32) -> i32 {
    (if x < 0.0 { x - 0.5 } else { x + 0.5 }) as i32
}

/// 2³².
const WORD: f32 = 4_294_967_296.0;

impl Real for f32 {
    type InDouble<T: State> = ();
    const ZERO: Self = 0.0;
    const HALF: Self = 0.5;
    const ONE: Self = 1.0;
    const TWO: Self = 2.0;
    const EPSILON: Self = f32::EPSILON;
    const LIMIT_SLACK: Self = 1e-5;
    const TOUCH_SLACK: Self = 1e-2;
    const AT_REST: Self = 1e-30;
    const IS_SINGLE: bool = true;
    const NAME: &'static str = "f32";

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "nearest is the contract")]
    fn from_f64(x: f64) -> Self {
        x as f32
    }

    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "`as` truncates and saturates, which is the contract"
    )]
    fn whole(self) -> u64 {
        // By halves of 32 bits, an instruction each; 64 are a routine.
        let high = (self / WORD) as u32;
        if high == u32::MAX {
            return u64::MAX;
        }
        let low = (self - high as f32 * WORD) as u32;
        (u64::from(high) << 32) + u64::from(low)
    }

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        reason = "halves, as in `whole`"
    )]
    fn from_whole(n: u64) -> Self {
        (n >> 32) as u32 as f32 * WORD + n as u32 as f32
    }

    #[inline]
    #[expect(clippy::cast_precision_loss, reason = "nearest is the contract")]
    fn from_count(n: i32) -> Self {
        n as f32
    }

    #[inline]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline]
    fn sqrt(self) -> Self {
        square_root(self)
    }

    #[inline]
    fn exp(self) -> Self {
        exp(self)
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn straight_sin_cos(self) -> (Self, Self, bool) {
        let (sin, cos) = straight(self);
        (sin, cos, Real::abs(self) <= 6000.0)
    }

    #[inline]
    fn atan2(self, x: Self) -> Self {
        atan2(self, x)
    }

    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of `f` against the f64 `truth` over `from..=to`.
    fn worst(from: f32, to: f32, f: impl Fn(f32) -> f32, truth: impl Fn(f64) -> f64) -> f64 {
        (0..=200_000_u32)
            .map(|i| {
                let x = f32::from_f64(
                    f64::from(from) + f64::from(to - from) * f64::from(i) / 200_000.0,
                );
                (f64::from(f(x)) - truth(f64::from(x))).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn sine_and_cosine_are_single_exact() {
        for range in [0.7, 10.0, 6000.0] {
            assert!(worst(-range, range, |x| sin_cos(x).0, libm::sin) < 2e-7);
            assert!(worst(-range, range, |x| sin_cos(x).1, libm::cos) < 2e-7);
        }
    }

    #[test]
    fn arc_tangent_is_single_exact_all_around() {
        let at = |r: f32| {
            worst(
                -PI,
                PI,
                |a| {
                    let (s, c) = (libm::sin(f64::from(a)), libm::cos(f64::from(a)));
                    let (y, x) = (f32::from_f64(s) * r, f32::from_f64(c) * r);
                    atan2(y, x) - f32::from_f64(libm::atan2(f64::from(y), f64::from(x)))
                },
                |_| 0.0,
            )
        };
        assert!(at(1.0) < 5e-7);
        assert!(at(1e-20) < 5e-7);
        assert!(at(1e20) < 5e-7);
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, -1.0), PI);
    }

    #[test]
    fn exponential_is_single_exact_and_ends_quietly() {
        let relative = |x: f32| f32::from_f64(f64::from(exp(x)) / libm::exp(f64::from(x)) - 1.0);
        assert!(worst(-80.0, 80.0, relative, |_| 0.0) < 3e-7);
        assert_eq!(exp(-1e6), 0.0);
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(1e6), f32::INFINITY);
    }

    #[test]
    fn odd_functions_are_odd_to_the_bit() {
        for i in 1..10_000_u16 {
            let x = f32::from(i) * 0.137;
            assert_eq!(sin_cos(-x).0.to_bits(), (-sin_cos(x).0).to_bits());
            assert_eq!(sin_cos(-x).1.to_bits(), sin_cos(x).1.to_bits());
            assert_eq!(atan2(-x, 1.5).to_bits(), (-atan2(x, 1.5)).to_bits());
        }
    }

    #[test]
    fn in_the_first_octant_every_term_of_a_series_counts() {
        // An error of a unit in the last place is 6e-8 above a half.
        assert!(worst(0.0, FRAC_PI_4, |x| sin_cos(x).0, libm::sin) < 7e-8);
        assert!(worst(0.0, FRAC_PI_4, |x| sin_cos(x).1, libm::cos) < 7e-8);
        assert!(worst(0.0, 1.0, |t| atan2(t, 1.0), libm::atan) < 1.1e-7);
    }

    #[test]
    fn the_exponential_ends_where_it_says() {
        let near = |x: f32| (f64::from(exp(x)) / libm::exp(f64::from(x)) - 1.0).abs() < 3e-7;
        assert!(near(-87.0) && near(88.0));
        assert_eq!((exp(-87.000_01), exp(88.000_01)), (0.0, f32::INFINITY));
    }
}

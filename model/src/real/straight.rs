//! Sine and cosine in f64 without a branch, with the bits of `libm`.
//!
//! The steps are those of `libm::sincos` for the sense and size of number that nearly all have: one
//! round of Cody and Waite's reduction by π/2, and both of its polynomials. What needs another way
//! there (a number close to a multiple of π/4, a very large or small one) is said, and left to it.

/// A number from which on a sum has whole numbers in its last bits: 1.5·2⁵².
const TO_WHOLE: f64 = 6_755_399_441_055_744.0;

/// π/2 = HI + LO; HI has 33 bits, so that its product with a small whole number is exact.
const QUARTER_HI: f64 = f64::from_bits(0x3FF9_21FB_5440_0000);
const QUARTER_LO: f64 = f64::from_bits(0x3DD0_B461_1A62_6331);

/// Rest after the quarters, if no other number of them may be meant: π/4 less a millionth.
const MOST_REST: f64 = core::f64::consts::FRAC_PI_4 * (1.0 - 1e-5);

/// −1/3!, 1/5!, … and 1/4!, −1/6!, …, each the best for the range.
const SINE: [f64; 6] = [
    f64::from_bits(0xBFC5_5555_5555_5549),
    f64::from_bits(0x3F81_1111_1110_F8A6),
    f64::from_bits(0xBF2A_01A0_19C1_61D5),
    f64::from_bits(0x3EC7_1DE3_57B1_FE7D),
    f64::from_bits(0xBE5A_E5E6_8A2B_9CEB),
    f64::from_bits(0x3DE5_D93A_5ACF_D57C),
];
const COSINE: [f64; 6] = [
    f64::from_bits(0x3FA5_5555_5555_554C),
    f64::from_bits(0xBF56_C16C_16C1_5177),
    f64::from_bits(0x3EFA_01A0_19CB_1590),
    f64::from_bits(0xBE92_7E4F_809C_52AD),
    f64::from_bits(0x3E21_EE9E_BDB4_B1C4),
    f64::from_bits(0xBDA8_FAE9_BE88_38D4),
];

/// (sin x, cos x), and whether they are those of `libm::sincos` to the bit.
#[inline(always)]
#[expect(clippy::inline_always, reason = "the target features of its caller")]
pub(super) fn straight_sin_cos(x: f64) -> (f64, f64, bool) {
    let shifted = x * core::f64::consts::FRAC_2_PI + TO_WHOLE;
    let quarters = shifted - TO_WHOLE;
    let r = x - quarters * QUARTER_HI;
    let w = quarters * QUARTER_LO;
    let y = r - w;
    let rest = (r - y) - w;
    // Elsewhere `libm` reduces by another number of quarters, or further.
    let rest_size = libm::fabs(y);
    let is_plain = (1e-3..1e5).contains(&x) & (x * 6.2e-5..MOST_REST).contains(&rest_size);
    let [s1, s2, s3, s4, s5, s6] = SINE;
    let z = y * y;
    let z2 = z * z;
    let series = s2 + z * (s3 + z * s4) + z * z2 * (s5 + z * s6);
    let cube = z * y;
    let sine = if quarters == 0.0 {
        y + cube * (s1 + z * series)
    } else {
        y - ((z * (0.5 * rest - cube * series) - rest) - cube * s1)
    };
    let [c1, c2, c3, c4, c5, c6] = COSINE;
    let series = z * (c1 + z * (c2 + z * c3)) + z2 * z2 * (c4 + z * (c5 + z * c6));
    let half = 0.5 * z;
    let top = 1.0 - half;
    let cosine = top + (((1.0 - top) - half) + (z * series - y * rest));
    let turns = shifted.to_bits();
    let (a, b) = if turns & 1 == 0 {
        (sine, cosine)
    } else {
        (cosine, sine)
    };
    let signed = |x: f64, turns: u64| f64::from_bits(x.to_bits() ^ ((turns & 2) << 62));
    (signed(a, turns), signed(b, turns.wrapping_add(1)), is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_that_of_libm(x: f64) -> bool {
        let (sin, cos, is_plain) = straight_sin_cos(x);
        let (s, c) = libm::sincos(x);
        if is_plain {
            assert_eq!(
                [sin.to_bits(), cos.to_bits()],
                [s.to_bits(), c.to_bits()],
                "{x:e}"
            );
        }
        is_plain
    }

    #[test]
    fn it_has_the_bits_of_libm() {
        let mut plain = 0;
        let count = 400_000;
        for n in 0..count {
            // The phase of a slip; other sizes need another way more often.
            let x = f64::from(n) * (7.0 / f64::from(count)) + 1e-3;
            plain += u32::from(is_that_of_libm(x));
            is_that_of_libm(x * x * x * 40.0);
        }
        assert!(plain > count - count / 1000, "{plain}");
    }

    #[test]
    fn near_the_multiples_of_an_eighth_it_says_so_or_is_right() {
        for eighths in 1..64 {
            let x = f64::from(eighths) * core::f64::consts::FRAC_PI_4;
            for exponent in 0..50 {
                for sign in [-1.0, 1.0] {
                    let near = x * (1.0 + sign * libm::exp2(-f64::from(exponent)) * 0.1);
                    is_that_of_libm(near);
                }
            }
            for ulps in 0..2_000 {
                is_that_of_libm(f64::from_bits(x.to_bits() + ulps));
                is_that_of_libm(f64::from_bits(x.to_bits() - ulps));
            }
        }
        for x in [0.0, -0.0, -1.0, 1e-300, 1e5, 1e300, f64::INFINITY, f64::NAN] {
            assert!(!straight_sin_cos(x).2, "{x}");
        }
    }
}

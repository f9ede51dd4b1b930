//! The encoder at the motor: the true shaft angle to whole counts.

use crepitus_model::control::encoder::EncoderSettings;

/// An ideal incremental encoder: it counts every edge and never loses one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    rad_per_count: f64,
}

impl Encoder {
    /// The encoder that `settings` describe.
    pub fn new(settings: &EncoderSettings) -> Self {
        Self {
            rad_per_count: settings.rad_per_count(),
        }
    }

    /// The counter at a shaft angle, as a 32-bit timer holds it: it wraps.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the low 32 bits are the counter; `as` saturates the rest"
    )]
    pub fn count(&self, phi_rad: f64) -> i32 {
        floor(phi_rad / self.rad_per_count) as i32
    }

    /// Joint angle of one count, rad.
    pub fn rad_per_count(&self) -> f64 {
        self.rad_per_count
    }
}

/// The whole number at or below `x`: `f64::floor`, which is a call into the C library.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "truncates and saturates; beyond 2^53 every f64 is whole"
)]
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole.saturating_sub(i64::from(whole as f64 > x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_whole_and_wrap() {
        let encoder = Encoder::new(&EncoderSettings::default());
        let count = encoder.rad_per_count();
        assert!((count - 35.67e-6).abs() < 0.01e-6);
        assert_eq!(encoder.count(0.0), 0);
        assert_eq!(encoder.count(0.99 * count), 0);
        assert_eq!(encoder.count(1.01 * count), 1);
        assert_eq!(encoder.count(-0.01 * count), -1);
        let before = encoder.count(2_147_483_647.5 * count);
        let after = encoder.count(2_147_483_648.5 * count);
        assert_eq!(after.wrapping_sub(before), 1);
        assert_eq!(after, i32::MIN);
    }

    #[test]
    fn whole_numbers_are_those_of_the_library() {
        let steps = (-4_000..=4_000).map(|n| f64::from(n) * 0.25);
        let near = steps.flat_map(|x| [x.next_down(), x, x.next_up()]);
        let far = [1e15 + 0.5, 9e15, 1e18, 1e19, 1e300, f64::INFINITY];
        for x in near.chain(far.into_iter().flat_map(|x| [x, -x])) {
            #[expect(clippy::cast_possible_truncation, reason = "saturates, as it does")]
            let expected = x.floor() as i64;
            assert_eq!(floor(x), expected, "{x:e}");
        }
        assert_eq!(floor(f64::NAN), 0);
    }
}

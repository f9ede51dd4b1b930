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
        (phi_rad / self.rad_per_count).floor() as i64 as i32
    }

    /// Joint angle of one count, rad.
    pub fn rad_per_count(&self) -> f64 {
        self.rad_per_count
    }
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
}

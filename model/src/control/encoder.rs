//! Shaft motion from the counts of the motor's quadrature encoder: the angle's
//! change and a velocity estimate.
//!
//! Counts wrap; their differences do not, so the angle never drifts however
//! many turns are made. The velocity comes from a tracking observer of the
//! angle, critically damped with both poles at the bandwidth f_b
//! (r = e^(−2π·f_b·h)):
//!
//! ```text
//! e = measured change + lag − Ω·h        innovation, rad
//! Ω ← Ω + (1 − r)²/h · e                  lag ← r²·e
//! ```
//!
//! The observer has no lag at constant speed, needs no absolute angle, and its noise is
//! one count over about 1/(2π·f_b) of time.

use crate::joint::{SettingsError, ShaftStep};
use crate::parameters::{Tabled, settings};
use crate::real::Real;

settings! {
    /// The encoder and its place in the drivetrain.
    pub struct EncoderSettings, group "encoder" {} {
        lines (6 disarmed) "N" "lines per motor turn", 1.0..=1e6, 512.0,
            "lines of the encoder disc; quadrature makes four counts of each";
        gear_ratio (7 disarmed) "i" "motor turns per joint turn", 1.0..=1e4, 86.0,
            "reduction between the motor, where the encoder sits, and the joint";
        velocity_bandwidth_hz (8 disarmed) "f_b" "Hz", 0.1..=1e4, 50.0,
            "bandwidth of the velocity estimate: higher follows faster, lower is quieter";
    }
}

impl EncoderSettings {
    /// Joint angle of one count, rad.
    pub fn rad_per_count(&self) -> f64 {
        core::f64::consts::TAU / (4.0 * self.lines * self.gear_ratio)
    }
}

/// Turns counts into steps of the shaft, one each time it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderReader<F> {
    rad_per_count: F,
    step_s: F,
    velocity_gain: F,
    lag_gain: F,
    last_count: i32,
    lag_rad: F,
    omega_rad_s: F,
}

impl<F: Real> EncoderReader<F> {
    /// A reader that is called every `step_s`, and starts at `count` with a
    /// settled estimate of `omega_rad_s`.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting is out of range.
    pub fn new(
        settings: &EncoderSettings,
        step_s: f64,
        count: i32,
        omega_rad_s: F,
    ) -> Result<Self, SettingsError> {
        settings.validate()?;
        let r = libm::exp(-core::f64::consts::TAU * settings.velocity_bandwidth_hz * step_s);
        Ok(Self {
            rad_per_count: F::from_f64(settings.rad_per_count()),
            step_s: F::from_f64(step_s),
            velocity_gain: F::from_f64((1.0 - r) * (1.0 - r) / step_s),
            lag_gain: F::from_f64(r * r),
            last_count: count,
            lag_rad: F::ZERO,
            omega_rad_s,
        })
    }

    /// Returns the reader at another count, with a settled estimate of
    /// `omega_rad_s`: cheap, where [`Self::new`] is not.
    #[must_use]
    pub fn restarted(self, count: i32, omega_rad_s: F) -> Self {
        Self {
            last_count: count,
            lag_rad: F::ZERO,
            omega_rad_s,
            ..self
        }
    }

    /// The estimate of the velocity, rad/s.
    pub fn omega_rad_s(&self) -> F {
        self.omega_rad_s
    }

    /// One tick without a count: the shaft is taken to move on as it did. The
    /// next count brings the travel of both ticks, so no angle is lost.
    #[inline]
    pub fn miss(&mut self) {
        self.lag_rad -= self.omega_rad_s * self.step_s;
    }

    /// Takes in the next count.
    #[inline]
    pub fn read(&mut self, count: i32) -> ShaftStep<F> {
        let delta = count.wrapping_sub(self.last_count);
        self.last_count = count;
        let delta_phi_rad = F::from_count(delta) * self.rad_per_count;
        let omega_start_rad_s = self.omega_rad_s;
        let innovation = delta_phi_rad + self.lag_rad - omega_start_rad_s * self.step_s;
        self.omega_rad_s += self.velocity_gain * innovation;
        self.lag_rad = self.lag_gain * innovation;
        ShaftStep {
            delta_phi_rad,
            omega_start_rad_s,
            omega_end_rad_s: self.omega_rad_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a shaft at constant speed for `seconds`, starting at `count`.
    fn run(omega: f64, start: i32, seconds: f64) -> (f64, std::vec::Vec<f64>) {
        let (settings, step_s) = (EncoderSettings::default(), 5e-5);
        let mut reader = EncoderReader::<f32>::new(&settings, step_s, start, 0.0).unwrap();
        let mut angle = 0.0;
        let mut estimates = std::vec::Vec::new();
        #[expect(clippy::cast_possible_truncation, reason = "small numbers")]
        for i in 1..=(seconds / step_s) as i32 {
            let counts = libm::floor(omega * f64::from(i) * step_s / settings.rad_per_count());
            let step = reader.read(start.wrapping_add(counts as i32));
            angle += f64::from(step.delta_phi_rad);
            estimates.push(f64::from(step.omega_end_rad_s));
        }
        (angle, estimates)
    }

    #[test]
    fn a_restarted_reader_goes_on_with_the_speed_it_is_given() {
        let reader = EncoderReader::<f32>::new(&EncoderSettings::default(), 5e-5, 0, 0.0);
        let mut reader = reader.unwrap().restarted(7, 1.5);
        assert_eq!(reader.omega_rad_s(), 1.5);
        let step = reader.read(7);
        assert_eq!((step.delta_phi_rad, step.omega_start_rad_s), (0.0, 1.5));
        assert_eq!(reader.omega_rad_s(), step.omega_end_rad_s);
    }

    #[test]
    fn the_estimate_settles_on_the_true_speed() {
        for omega in [0.05, 1.0, -3.0] {
            let (_, estimates) = run(omega, 0, 0.2);
            for estimate in &estimates[2000..] {
                // One count is 36 µrad; over 1/(2π·50 Hz) that is 11 mrad/s.
                assert!((estimate - omega).abs() < 0.012, "{estimate} for {omega}");
            }
        }
    }

    #[test]
    fn a_counter_that_wraps_changes_nothing() {
        assert_eq!(run(3.0, 0, 0.1).1, run(3.0, i32::MAX - 5, 0.1).1);
        assert_eq!(run(-3.0, 0, 0.1).1, run(-3.0, i32::MIN + 5, 0.1).1);
    }

    #[test]
    fn the_angle_does_not_drift() {
        let (angle, _) = run(2.0, 77, 2.0);
        assert!((angle - 4.0).abs() < 40e-6, "{angle}");
    }

    #[test]
    fn settings_are_their_table_and_are_held_to_it() {
        let mut settings = EncoderSettings::default();
        assert_eq!(settings.values(), [512.0, 86.0, 50.0]);
        assert!((settings.rad_per_count() - 35.674e-6).abs() < 1e-9);
        assert_eq!(settings.validate(), Ok(()));
        for (i, spec) in EncoderSettings::TABLE.iter().enumerate() {
            for (bad, good) in [
                (f64::NAN, spec.default),
                (spec.min * 0.99, spec.min),
                (spec.max * 1.01, spec.max),
            ] {
                *settings.values_mut()[i] = bad;
                let refused = settings.validate();
                assert!(matches!(refused, Err(refused) if refused.parameter.key == spec.key));
                *settings.values_mut()[i] = good;
                assert_eq!(settings.validate(), Ok(()), "{good}");
            }
            *settings.values_mut()[i] = spec.default;
        }
    }

    #[test]
    fn a_missed_count_costs_no_angle_and_hardly_any_speed() {
        let (settings, step_s) = (EncoderSettings::default(), 5e-5);
        let omega = 2.0;
        let mut reader = EncoderReader::<f64>::new(&settings, step_s, 0, omega).unwrap();
        let (mut angle, mut worst) = (0.0, 0.0_f64);
        for i in 1..=20_000_i32 {
            if i % 3 == 0 {
                reader.miss();
                continue;
            }
            let counts = libm::floor(omega * f64::from(i) * step_s / settings.rad_per_count());
            #[expect(clippy::cast_possible_truncation, reason = "small numbers")]
            let step = reader.read(counts as i32);
            angle += step.delta_phi_rad;
            worst = worst.max((step.omega_end_rad_s - omega).abs());
        }
        assert!((angle - omega).abs() < 40e-6, "{angle}");
        assert!(worst < 0.02, "{worst}");
    }
}

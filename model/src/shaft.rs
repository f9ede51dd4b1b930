//! What the model is told of the shaft, and the path it assumes within a step.

use crate::active::Active;
use crate::real::Real;

/// The shaft's motion over one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaftStep<F> {
    /// The exact change of the shaft angle over the step, rad.
    pub delta_phi_rad: F,
    /// Shaft velocity just after the start of the step, Ω(tₙ⁺), rad/s.
    pub omega_start_rad_s: F,
    /// Shaft velocity just before its end, Ω(tₙ₊₁⁻), rad/s.
    pub omega_end_rad_s: F,
}

impl<F: Real> ShaftStep<F> {
    /// Change of the angle after `fraction` of a step of `step_s`, rad, on the
    /// path that [`ShaftPath`] assumes.
    pub fn travel(&self, fraction: F, step_s: F) -> F {
        let bend = (self.omega_end_rad_s - self.omega_start_rad_s) * step_s;
        self.delta_phi_rad * fraction - F::HALF * bend * fraction * (F::ONE - fraction)
    }
}

/// The path within the step: Ω is linear, and the angle the parabola of that
/// slope which ends exactly at Δφ.
///
/// The angle's velocity therefore differs from Ω by the constant
/// Δφ/h − (Ω₀ + Ω₁)/2, which is the error of the trapezoidal rule for an
/// analytic motion and the estimator's error on a device. Position events
/// (break) use the angle, velocity events (match) use Ω.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftPath<F> {
    /// Velocity of the angle at the start, rad/s.
    rate: F,
    /// Ω at the start, rad/s.
    omega: F,
    /// Ω̇, rad/s².
    pub omega_dot: F,
}

impl<F: Real> ShaftPath<F> {
    /// The path of a step of the length that `active` was made for.
    #[inline]
    pub fn new(step: &ShaftStep<F>, active: &Active<F>) -> Self {
        let omega_dot = (step.omega_end_rad_s - step.omega_start_rad_s) * active.per_step;
        Self {
            rate: step.delta_phi_rad * active.per_step - F::HALF * omega_dot * active.step_s,
            omega: step.omega_start_rad_s,
            omega_dot,
        }
    }

    /// Ω at `time_s` into the step, rad/s.
    #[inline]
    pub fn omega(&self, time_s: F) -> F {
        self.omega + self.omega_dot * time_s
    }

    /// Velocity of the angle at `time_s` into the step, rad/s.
    #[inline]
    pub fn rate(&self, time_s: F) -> F {
        self.rate + self.omega_dot * time_s
    }

    /// Change of the angle between two times within the step, rad.
    #[inline]
    pub fn travel(&self, from_s: F, to_s: F) -> F {
        (to_s - from_s) * (self.rate + F::HALF * self.omega_dot * (from_s + to_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;

    #[test]
    fn the_path_ends_where_the_sensor_says_and_bends_as_the_velocity_does() {
        let step = ShaftStep {
            delta_phi_rad: 3e-3,
            omega_start_rad_s: 1.0,
            omega_end_rad_s: 4.0,
        };
        let active = Active::new(&Settings::default().validate().unwrap(), 1e-3).unwrap();
        let path = ShaftPath::<f64>::new(&step, &active);
        assert!((path.omega_dot - 3000.0).abs() < 1e-9);
        assert!((path.omega(5e-4) - 2.5).abs() < 1e-12);
        // The mean rate is Δφ/h = 3 rad/s, half a radian above that of Ω.
        assert!((path.rate(0.0) - 1.5).abs() < 1e-12 && (path.rate(1e-3) - 4.5).abs() < 1e-12);
        assert!((path.travel(0.0, 1e-3) - 3e-3).abs() < 1e-15);
        for fraction in [0.0, 0.25, 0.5, 1.0] {
            let to_s = fraction * 1e-3;
            let travel = 1.5 * to_s + 1500.0 * to_s * to_s;
            assert!((path.travel(0.0, to_s) - travel).abs() < 1e-15);
            assert!((step.travel(fraction, 1e-3) - travel).abs() < 1e-15);
            assert!((path.travel(to_s, 1e-3) - (3e-3 - travel)).abs() < 1e-15);
        }
    }
}

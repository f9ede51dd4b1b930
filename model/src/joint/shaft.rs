//! The shaft's motion over one step, and the path assumed within it.
//!
//! A step gives three numbers: Δφ, Ω₀ and Ω₁. Two paths are made of them:
//!
//! ```text
//! Linear      Ω linear; the angle is the parabola of that slope which ends exactly at Δφ
//! Quadratic   Ω quadratic; the angle is the cubic (Hermite) with these velocities at its ends and this Δφ
//!
//!             Ω̇(0) = (Ω₁ − Ω₀)/h + 6d/h      Ω̈ = −12d/h²      d = Δφ/h − (Ω₀ + Ω₁)/2
//! ```
//!
//! d is the error of the trapezoidal rule for an analytic motion, −h²·Ω̈/12, and
//! the estimator's error on a device. The linear path leaves it as a difference
//! between Ω and the velocity of the angle; its Ω̇ is wrong by h·Ω̈/2 at the ends
//! of the step. The quadratic path takes it for bend: its Ω̇ is wrong by
//! h²·|d³Ω/dt³|/12 at most. It needs a Δφ that is exact: an error ε becomes
//! 6ε/h² of Ω̇. At 50 µs that is 5e-7 rad/s² for the rounding of an f64 angle of
//! 1 rad, 1e-2 rad/s² for a step at 1 rad/s rounded to f32 (on a hand's motion
//! h·Ω̈/2 is a hundredth of that), and 9e4 rad/s² for one count of an encoder. A d·h
//! that is no more than the rounding of an angle of 4 rad counts as none, so that a
//! straight motion of a knee stays straight to the bit.

use crate::joint::StepCoefficients;
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

/// The path within the step, of the shape `V` that a solver assumes.
///
/// Position events (break) use the angle, velocity events (match) use Ω.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftPath<F, V = Linear> {
    /// Velocity of the angle at the start, rad/s.
    rate: F,
    /// Ω at the start, rad/s.
    omega: F,
    /// Ω̇ at the start, rad/s².
    omega_dot: F,
    /// Course of Ω̇ over time.
    shape: V,
}

impl<F: Real, V: VelocityShape<F>> ShaftPath<F, V> {
    /// The path of a step of the length that `coefficients` was made for.
    #[inline]
    pub fn new(step: &ShaftStep<F>, coefficients: &StepCoefficients<F>) -> Self {
        V::path(step, coefficients)
    }

    /// Ω at `time_s` into the step, rad/s.
    #[inline]
    pub fn omega(&self, time_s: F) -> F {
        self.shape
            .plus(self.omega + self.omega_dot * time_s, || half_square(time_s))
    }

    /// Ω̇ at `time_s` into the step, rad/s².
    #[inline]
    pub fn omega_dot(&self, time_s: F) -> F {
        self.shape.plus(self.omega_dot, || time_s)
    }

    /// Course of Ω̇ over time.
    #[inline]
    pub fn shape(&self) -> V {
        self.shape
    }

    /// Velocity of the angle at `time_s` into the step, rad/s.
    #[inline]
    pub fn rate(&self, time_s: F) -> F {
        self.shape
            .plus(self.rate + self.omega_dot * time_s, || half_square(time_s))
    }

    /// Change of the angle between two times within the step, rad.
    #[inline]
    pub fn travel(&self, from_s: F, to_s: F) -> F {
        let mean = self.rate + F::HALF * self.omega_dot * (from_s + to_s);
        (to_s - from_s)
            * self.shape.plus(mean, || {
                F::from_f64(1.0 / 6.0) * (to_s * to_s + to_s * from_s + from_s * from_s)
            })
    }
}

/// u²/2.
#[inline]
fn half_square<F: Real>(u: F) -> F {
    F::HALF * u * u
}

/// The course of Ω̇ within a step: constant, or linear.
///
/// A polynomial in time gets its term of Ω̈ through [`plus`](Self::plus), which
/// for [`Linear`] computes nothing.
pub trait VelocityShape<F: Real>: Copy + 'static {
    /// The path of this shape through a step.
    fn path(step: &ShaftStep<F>, coefficients: &StepCoefficients<F>) -> ShaftPath<F, Self>;

    /// `x` + Ω̈·`factor`.
    fn plus(self, x: F, factor: impl FnOnce() -> F) -> F;

    /// |Ω̈| + `x`.
    fn bound(self, x: F) -> F;

    /// The shape of what grows with the angle, `by` for each radian.
    #[must_use]
    fn times(self, by: F) -> Self;
}

/// Constant Ω̇.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Linear;

/// Linear Ω̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic<F> {
    /// Ω̈, rad/s³.
    pub omega_ddot: F,
}

impl<F: Real> VelocityShape<F> for Linear {
    #[inline]
    fn path(step: &ShaftStep<F>, coefficients: &StepCoefficients<F>) -> ShaftPath<F, Self> {
        let omega_dot = (step.omega_end_rad_s - step.omega_start_rad_s) * coefficients.per_step;
        ShaftPath {
            rate: step.delta_phi_rad * coefficients.per_step
                - F::HALF * omega_dot * coefficients.step_s,
            omega: step.omega_start_rad_s,
            omega_dot,
            shape: Self,
        }
    }

    #[inline]
    fn plus(self, x: F, _: impl FnOnce() -> F) -> F {
        x
    }

    #[inline]
    fn bound(self, x: F) -> F {
        x
    }

    #[inline]
    fn times(self, _: F) -> Self {
        self
    }
}

impl<F: Real> VelocityShape<F> for Quadratic<F> {
    #[inline]
    fn path(step: &ShaftStep<F>, coefficients: &StepCoefficients<F>) -> ShaftPath<F, Self> {
        let (from, to) = (step.omega_start_rad_s, step.omega_end_rad_s);
        let chord = F::HALF * (from + to) * coefficients.step_s;
        let beside = step.delta_phi_rad - chord;
        // Less than the rounding of an angle of 4 rad is no bend.
        let bend = if beside.abs() <= F::from_f64(4.0) * F::EPSILON {
            F::ZERO
        } else {
            F::from_f64(6.0) * beside * coefficients.per_step
        };
        ShaftPath {
            rate: from,
            omega: from,
            omega_dot: ((to - from) + bend) * coefficients.per_step,
            shape: Self {
                omega_ddot: -(F::TWO * bend * coefficients.per_step * coefficients.per_step),
            },
        }
    }

    #[inline]
    fn plus(self, x: F, factor: impl FnOnce() -> F) -> F {
        x + self.omega_ddot * factor()
    }

    #[inline]
    fn bound(self, x: F) -> F {
        x + self.omega_ddot.abs()
    }

    #[inline]
    fn times(self, by: F) -> Self {
        Self {
            omega_ddot: self.omega_ddot * by,
        }
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
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), 1e-3).unwrap();
        let path = ShaftPath::<f64, Linear>::new(&step, &coefficients);
        assert!((path.omega_dot(5e-4) - 3000.0).abs() < 1e-9);
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

    #[test]
    fn the_rounding_of_an_angle_is_no_bend() {
        let coefficients =
            StepCoefficients::<f64>::new(&Settings::default().validate().unwrap(), 5e-5).unwrap();
        let path = |phi: f64, more_rad: f64| {
            let step = ShaftStep {
                delta_phi_rad: (phi + 5e-5 + more_rad) - phi,
                omega_start_rad_s: 1.0,
                omega_end_rad_s: 1.0,
            };
            ShaftPath::<f64, Quadratic<f64>>::new(&step, &coefficients)
        };
        for phi in [0.0, 0.3, 1.1, 2.7, 3.99] {
            assert_eq!(path(phi, 0.0).omega_dot(5e-5), 0.0, "{phi}");
            // Ω̈ = 3 rad/s³, as of a hand's sine: −h³·Ω̈/12.
            let bent = path(phi, -3.1e-14);
            assert!((bent.shape().omega_ddot / 3.0 - 1.0).abs() < 0.1, "{phi}");
        }
    }

    /// Both angles of a step are rounded, and each as it likes.
    #[test]
    fn a_straight_motion_of_a_knee_stays_straight_to_the_bit() {
        let step_s = 5e-5;
        let coefficients =
            StepCoefficients::<f64>::new(&Settings::default().validate().unwrap(), step_s).unwrap();
        // From 0 to 4 rad at 1 rad/s.
        for tick in 0..79_999 {
            let [from_rad, to_rad] = [tick, tick + 1].map(|tick| f64::from(tick) * step_s);
            let step = ShaftStep {
                delta_phi_rad: to_rad - from_rad,
                omega_start_rad_s: 1.0,
                omega_end_rad_s: 1.0,
            };
            let path = ShaftPath::<f64, Quadratic<f64>>::new(&step, &coefficients);
            assert_eq!(path.omega_dot(0.0), 0.0, "{from_rad} rad");
            assert_eq!(path.shape().omega_ddot, 0.0, "{from_rad} rad");
        }
    }

    #[test]
    fn a_bend_of_either_sign_widens_a_bound_and_scales() {
        for omega_ddot in [2.0, -2.0] {
            let shape = Quadratic { omega_ddot };
            assert_eq!(shape.bound(3.0), 5.0);
            assert_eq!(shape.times(0.25).omega_ddot, 0.25 * omega_ddot);
            assert_eq!(shape.plus(3.0, || 0.5), 3.0 + 0.5 * omega_ddot);
        }
        assert_eq!(Linear.bound(3.0), 3.0);
        assert_eq!(Linear.plus(3.0, || 0.5), 3.0);
    }

    #[test]
    fn the_quadratic_path_is_a_cubic_motion_to_rounding() {
        // φ = 0.3 + 2t − 40t² + 3e4·t³, over a millisecond from 2 ms on.
        let phi = |t: f64| ((3e4 * t - 40.0) * t + 2.0) * t + 0.3;
        let omega = |t: f64| (9e4 * t - 80.0) * t + 2.0;
        let (from_s, step_s) = (2e-3, 1e-3);
        let step = ShaftStep {
            delta_phi_rad: phi(from_s + step_s) - phi(from_s),
            omega_start_rad_s: omega(from_s),
            omega_end_rad_s: omega(from_s + step_s),
        };
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), step_s).unwrap();
        let path = ShaftPath::<f64, Quadratic<f64>>::new(&step, &coefficients);
        assert!((path.shape().omega_ddot - 1.8e5).abs() < 1e-2);
        for fraction in [0.0, 0.25, 0.5, 1.0] {
            let u = fraction * step_s;
            let t = from_s + u;
            assert!((path.omega(u) - omega(t)).abs() < 1e-12, "{fraction}");
            assert_eq!(path.rate(u), path.omega(u));
            assert!((path.omega_dot(u) - (1.8e5 * t - 80.0)).abs() < 1e-8);
            assert!((path.travel(0.0, u) - (phi(t) - phi(from_s))).abs() < 1e-15);
            assert!((path.travel(u, step_s) - (phi(from_s + step_s) - phi(t))).abs() < 1e-15);
        }
    }
}

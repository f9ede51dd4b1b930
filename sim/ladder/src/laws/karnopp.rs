//! Karnopp's law, with the joint's object in it: the law needs the torques on the body.
//!
//! ```text
//! w = Ω − θ̇                                needed = J·(Ω₁ − θ̇)/h + c·Ω₁ + k·θ₁
//!
//! |w| ≤ Dv   sticks: T = needed, within ±Ts; below Ts the object moves with the shaft
//! |w| > Dv   slips:  T = Tk·sgn(w)                              J·θ̈ = T − c·θ̇ − k·θ
//! ```
//!
//! Source: D. Karnopp, Computer simulation of stick-slip friction in mechanical dynamic systems,
//! Journal of Dynamic Systems, Measurement, and Control 107(1), 100–103, 1985,
//! DOI 10.1115/1.3140698. J, k and c are those of the joint: there is no stiffness of a contact.
//!
//! **Band.** Dv = h·(Ts + Tk)/(2·J). In a slip the relative velocity changes by
//! h·(Tk + |k·θ|)/J in a step at most, besides what the shaft changes, so with |k·θ| ≤ Ts it
//! cannot jump over the band, 2·Dv wide. A narrower band is missed now and then: the torque
//! then alternates between ±Tk, or a slip that should end goes on backwards. At 50 µs, Dv of the
//! joint of the paper is 1.5 % of the swing of the object's velocity, (Ts − Tk)/√(J·k).
//!
//! **Discretisation.** The phase follows from w at the start of the step: θ and θ̇ are
//! all the state. With T constant a slip, and a stick at its limit, is the exact
//! motion of a damped oscillator about T/k. A step that enters the band ends with θ̇ = Ω₁.
//! The torque is that which acts on the object in the step.
//!
//! **Traps.** 1. A stick that keeps the w it was entered with creeps along the shaft; here
//! the object takes the shaft's velocity and its travel, so there is no drift, at the price of
//! up to J·Dv²/2 of energy each time. 2. A stick breaks late: at Ts the object has to leave the
//! band first, which takes t = √(2·J·Dv/(k·Ω)), so Ts is shown for longer. The drop then is
//! larger, sticks last 2·t longer and slips 2·t/(1 + x²) less, x = (Ts − Tk)/(Ω·√(J·k)):
//! a cycle of the joint of the paper at 50 µs is 2.6 % too long at 0.1 rad/s, 0.1 % at
//! 0.5 rad/s and 0.03 % at 1 rad/s. It falls with √h. (Tk instead of Ts once `needed` exceeds Ts
//! would make it 0.04 % at 0.1 rad/s, but is not Karnopp's law.) 3. `needed` contains the
//! shaft's acceleration, so noise ΔΩ of the velocity is a torque J·ΔΩ/h in stick, and breaks it
//! above Ts: for the joint of the paper at 50 µs, 2 mrad/s do.

use super::mounted::Mounted;
use crepitus_model::joint::compensated::Compensated;
use crepitus_model::joint::oscillator::Transition;
use crepitus_model::{
    Convention, Parameters, Real, Restart, Settings, SettingsError, ShaftStep, StepCoefficients,
};

/// Karnopp's law and the object.
#[derive(Clone, Copy, Debug)]
pub struct Karnopp<F> {
    coefficients: Coefficients<F>,
    theta: Compensated<F>,
    theta_dot_rad_s: F,
}

/// Numbers of a step.
#[derive(Clone, Copy, Debug)]
struct Coefficients<F> {
    stiffness: F,
    damping: F,
    /// J/h, N·m·s/rad.
    inertia_per_step: F,
    static_nm: F,
    kinetic_nm: F,
    /// Ts/k, rad.
    static_angle_rad: F,
    /// Tk/k, rad.
    kinetic_angle_rad: F,
    /// Dv, rad/s.
    band_rad_s: F,
    /// The object's motion in a step under a constant torque.
    motion: Transition<F>,
}

impl<F: Real> Coefficients<F> {
    fn new(joint: &Parameters, step_s: f64) -> Result<Self, SettingsError> {
        let settings = Settings {
            parameters: *joint,
            convention: Convention::Physical,
            restart: Restart::Elastic,
        };
        let a = StepCoefficients::<F>::new(&settings.validate()?, step_s)?;
        Ok(Self {
            stiffness: a.stiffness,
            damping: a.damping,
            inertia_per_step: F::from_f64(joint.inertia_kg_m2 / step_s),
            static_nm: a.static_nm,
            kinetic_nm: a.kinetic_nm,
            static_angle_rad: a.static_angle_rad,
            kinetic_angle_rad: a.kinetic_angle_rad,
            band_rad_s: F::from_f64(band_rad_s(joint, step_s)),
            motion: a.oscillator.transition(a.step_s),
        })
    }
}

/// Half width Dv of the band, rad/s.
pub fn band_rad_s(joint: &Parameters, step_s: f64) -> f64 {
    0.5 * step_s * (joint.static_torque_nm + joint.kinetic_torque_nm) / joint.inertia_kg_m2
}

impl<F: Real> Karnopp<F> {
    /// The object of this joint without torque, in stick on a shaft that moves with
    /// `omega_rad_s`.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid.
    pub fn fitted(joint: &Parameters, step_s: f64, omega_rad_s: F) -> Result<Self, SettingsError> {
        Ok(Self {
            coefficients: Coefficients::new(joint, step_s)?,
            theta: Compensated::new(F::ZERO),
            theta_dot_rad_s: omega_rad_s,
        })
    }

    /// Moves the object under T = k·`angle_rad`; returns whether it leaves or stays out of the
    /// band.
    #[inline]
    fn swing(&mut self, angle_rad: F, omega_end_rad_s: F) -> bool {
        let x = self.theta.value() - angle_rad;
        let (x, velocity) = self.coefficients.motion.apply(x, self.theta_dot_rad_s);
        self.theta = Compensated::new(x + angle_rad);
        self.theta_dot_rad_s = velocity;
        (omega_end_rad_s - velocity).abs() > self.coefficients.band_rad_s
    }

    /// A step that begins within the band.
    #[inline]
    fn stick(&mut self, shaft: &ShaftStep<F>) -> F {
        let a = &self.coefficients;
        let omega = shaft.omega_end_rad_s;
        let needed_nm = a.inertia_per_step * (omega - self.theta_dot_rad_s)
            + a.damping * omega
            + a.stiffness * (self.theta.value() + shaft.delta_phi_rad);
        if needed_nm.abs() <= a.static_nm {
            self.theta.add(shaft.delta_phi_rad);
            self.theta_dot_rad_s = omega;
            return needed_nm;
        }
        let (torque_nm, angle_rad) = signed(needed_nm, (a.static_nm, a.static_angle_rad));
        self.swing(angle_rad, omega);
        torque_nm
    }

    /// A step that begins outside of it, with the relative velocity `relative_rad_s`.
    #[inline]
    fn slip(&mut self, shaft: &ShaftStep<F>, relative_rad_s: F) -> F {
        let a = &self.coefficients;
        let (torque_nm, angle_rad) = signed(relative_rad_s, (a.kinetic_nm, a.kinetic_angle_rad));
        if !self.swing(angle_rad, shaft.omega_end_rad_s) {
            self.theta_dot_rad_s = shaft.omega_end_rad_s;
        }
        torque_nm
    }
}

/// Both numbers with the sign of `of`.
#[inline]
fn signed<F: Real>(of: F, (torque_nm, angle_rad): (F, F)) -> (F, F) {
    if of < F::ZERO {
        (-torque_nm, -angle_rad)
    } else {
        (torque_nm, angle_rad)
    }
}

impl<F: Real> Mounted<F> for Karnopp<F> {
    /// Angle and velocity of the object are kept. (A device ramps its parameters: a stiffer
    /// spring shows more torque at once.)
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
        self.coefficients = Coefficients::new(joint, step_s)?;
        Ok(())
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let relative_rad_s = shaft.omega_start_rad_s - self.theta_dot_rad_s;
        if relative_rad_s.abs() > self.coefficients.band_rad_s {
            self.slip(shaft, relative_rad_s)
        } else {
            self.stick(shaft)
        }
    }
}

#[cfg(test)]
mod tests;

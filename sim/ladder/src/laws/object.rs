//! The imaginary object under any law: J·θ̈ = T − c·θ̇ − k·θ.
//!
//! The law sees the shaft's motion relative to the object. The coupling is
//! explicit, as a controller would write it: the law moves first, with the
//! object's velocity at the start of the step; then its torque moves the object
//! by the semi-implicit Euler method. What the hand feels is the law's torque.

use super::contact::Body;
use super::mounted::{Mounted, check};
use super::{Contact, FrictionLaw};
use crepitus_model::{Parameters, Real, SettingsError, ShaftStep};

/// A law, and the object that it moves.
#[derive(Clone, Copy, Debug)]
pub struct OnObject<F, L> {
    law: L,
    theta_rad: F,
    theta_dot_rad_s: F,
    step_s: F,
    /// h/J, 1/(kg·m²/s).
    per_inertia: F,
    stiffness: F,
    damping: F,
}

impl<F: Real, L: FrictionLaw<F>> OnObject<F, L> {
    /// The law and the object for this joint, without torque, on a shaft that moves with
    /// `omega_rad_s`: the object moves with it, and neither its spring nor the contact is
    /// deflected.
    pub fn fitted(joint: &Parameters, step_s: f64, omega_rad_s: F) -> Self {
        let (contact, body) = Contact::on_object(joint);
        let mut object = Self {
            law: L::new(&L::fitted(&contact), step_s),
            theta_rad: F::ZERO,
            theta_dot_rad_s: omega_rad_s,
            step_s: F::from_f64(step_s),
            per_inertia: F::ZERO,
            stiffness: F::ZERO,
            damping: F::ZERO,
        };
        object.set(&body, step_s);
        object
    }

    fn set(&mut self, body: &Body, step_s: f64) {
        self.per_inertia = F::from_f64(step_s / body.inertia_kg_m2);
        self.stiffness = F::from_f64(body.stiffness_nm_per_rad);
        self.damping = F::from_f64(body.damping_nms_per_rad);
    }
}

impl<F: Real, L: FrictionLaw<F>> Mounted<F> for OnObject<F, L> {
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
        check(joint, step_s)?;
        let (contact, body) = Contact::on_object(joint);
        self.law.change(&L::fitted(&contact), step_s);
        self.set(&body, step_s);
        Ok(())
    }

    fn carry(&mut self, omega_rad_s: F) {
        self.theta_dot_rad_s = omega_rad_s;
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let velocity = self.theta_dot_rad_s;
        let torque_nm = self.law.step(&ShaftStep {
            delta_phi_rad: shaft.delta_phi_rad - velocity * self.step_s,
            omega_start_rad_s: shaft.omega_start_rad_s - velocity,
            omega_end_rad_s: shaft.omega_end_rad_s - velocity,
        });
        let sum_nm = torque_nm - self.stiffness * self.theta_rad - self.damping * velocity;
        self.theta_dot_rad_s = velocity + self.per_inertia * sum_nm;
        self.theta_rad += self.theta_dot_rad_s * self.step_s;
        torque_nm
    }
}

//! Coulomb friction in series with a spring and a damper, by the implicit Euler method: the law of
//! Kikuuwe and others for fixed steps.
//!
//! The friction is set-valued: while nothing slips it bears any torque up to its
//! level F. The implicit step has a closed form: a saturation.
//!
//! ```text
//! T = K·e + B·ė,     T ∈ F·sgn(v),     ė = Ω − v                e: deflection, v: slip velocity
//!
//! Tₙ = K·eₙ + B·(eₙ − eₙ₋₁)/h          eₙ = eₙ₋₁ + Δφ − h·vₙ
//!
//! T* = K·(eₙ₋₁ + Δφ) + B·Δφ/h          the torque if nothing slipped
//! Tₙ = T* held within ±F
//! K·eₙ = K·(eₙ₋₁ + Δφ) in stick,  Tₙ − (Tₙ − K·eₙ₋₁)·(B/h)/(K + B/h) in slip
//! ```
//!
//! Source: R. Kikuuwe, N. Takesue, A. Sano, H. Mochiyama, H. Fujimoto, "Admittance
//! and impedance representations of friction based on implicit Euler
//! integration", IEEE Transactions on Robotics 22(6), 2006, pp. 1176–1188; the
//! impedance form. Motion is taken from the change of the angle, so that the law
//! needs no estimated velocity.
//!
//! **Two levels.** F is Tk in the sense of a slip that was in the step before, and
//! Ts otherwise: the level is that of the state before, the torque is implicit.
//! A break shows Ts in its own step and Tk from the next. A slip ends when T* falls
//! below Tk. The source also has rate-dependent friction g(v), again implicit. For
//! the sudden drop of the fit, (Ts − Tk)/vs > K·h + B, this has several solutions.
//! If stick is taken wherever it is one, a slip ends a step after its break, where
//! T* = Tk + (K·h + B)·Ω is below Ts. The rule here is g(v) with vs → 0, and the
//! slip is kept as long as it is a solution. The Stribeck velocity is not used.
//!
//! Fit: Ts, Tk, K and B of the contact. B does not fall with the velocity, as σ1(v) of the bristles
//! does: spring and damper are in series with the friction, whose level bounds both. On the shaft
//! (B = 0) it slides at Tk and never grates. On an object it grates while a stick is longer than the
//! swing of the contact's own spring: up to about twenty times (Ts − Tk)/√(J·kr), the swing of the
//! object's velocity, and slides at Tk beyond. Half the damping makes that ten times.
//!
//! Known traps:
//! - A step without motion does not end a slip, else a slow shaft would break again
//!   at every encoder count. So a shaft that stops in a slip and goes on the same
//!   way does not meet Ts; one that turns back a little does.
//! - B·Δφ/h turns an encoder count into a spike of the torque; with B = 0 it cannot.
//! - K·e is summed rather than e, with compensation: it is kept when parameters
//!   change, and does not drift in f32.
//! - Coefficients depend on h: steps of another length need `change`.

use super::{Contact, FrictionLaw};
use crepitus_model::joint::compensated::Compensated;
use crepitus_model::{Real, Sense, ShaftStep};

/// The implicit law of Kikuuwe and others.
#[derive(Clone, Copy, Debug)]
pub struct Kikuuwe<F> {
    /// K·e, N·m.
    spring: Compensated<F>,
    /// Sense of the slip in the last step; `None` in stick.
    slip: Option<Sense>,
    stiffness: F,
    /// B/h, N·m/rad.
    damping_per_step: F,
    /// (B/h)/(K + B/h).
    kept: F,
    static_nm: F,
    kinetic_nm: F,
}

impl<F: Real> Kikuuwe<F> {
    fn set(&mut self, contact: &Contact, step_s: f64) {
        let stiffness = contact.stiffness_nm_per_rad;
        let damping = contact.damping_nms_per_rad / step_s;
        self.stiffness = F::from_f64(stiffness);
        self.damping_per_step = F::from_f64(damping);
        self.kept = F::from_f64(damping / (stiffness + damping));
        self.static_nm = F::from_f64(contact.static_torque_nm);
        self.kinetic_nm = F::from_f64(contact.kinetic_torque_nm);
    }

    /// Slips with a torque, from the spring's torque before the step.
    #[inline]
    fn slide(&mut self, sense: Sense, torque_nm: F) -> F {
        let lag_nm = torque_nm - self.spring.value();
        self.spring = Compensated::new(torque_nm - self.kept * lag_nm);
        self.slip = Some(sense);
        torque_nm
    }
}

impl<F: Real> FrictionLaw<F> for Kikuuwe<F> {
    type Parameters = Contact;

    fn fitted(contact: &Contact) -> Contact {
        *contact
    }

    fn new(contact: &Contact, step_s: f64) -> Self {
        let mut law = Self {
            spring: Compensated::new(F::ZERO),
            slip: None,
            stiffness: F::ZERO,
            damping_per_step: F::ZERO,
            kept: F::ZERO,
            static_nm: F::ZERO,
            kinetic_nm: F::ZERO,
        };
        law.set(contact, step_s);
        law
    }

    /// The torque of the spring and a slip stay; the levels hold from the next step on.
    fn change(&mut self, contact: &Contact, step_s: f64) {
        self.set(contact, step_s);
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let mut stuck = self.spring;
        stuck.add(self.stiffness * shaft.delta_phi_rad);
        let trial_nm = stuck.value() + self.damping_per_step * shaft.delta_phi_rad;
        let level = |sense| {
            if self.slip == Some(sense) {
                self.kinetic_nm
            } else {
                self.static_nm
            }
        };
        let (high, low) = (level(Sense::Positive), -level(Sense::Negative));
        if trial_nm >= high {
            self.slide(Sense::Positive, high)
        } else if trial_nm <= low {
            self.slide(Sense::Negative, low)
        } else {
            self.spring = stuck;
            self.slip = None;
            trial_nm
        }
    }
}

#[cfg(test)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "numbers of steps"
)]
mod tests;

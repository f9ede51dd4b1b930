//! Friction of displacement: the law of Hayward and Armstrong, made for haptic rendering.
//!
//! The shaft at x pulls with a spring at a point w where it adheres. The point
//! follows the travel of the shaft, not the time: no velocity is used, and the
//! torque depends on the sequence of angles alone.
//!
//! ```text
//! z = x − w        T = k·z        dw = α(z)·z·|dx|
//!
//! α(z) = 0 for |z| ≤ z_stick, 1/z_slide beyond
//! ```
//!
//! | regime | where | what w does |
//! |---|---|---|
//! | creep | z_stick = 0 | follows any motion: α is a constant, and the law is Dahl's; it drifts |
//! | stick, then creep | 0 < z_stick < z_slide | rests up to z_stick: no drift |
//! | stick, then slide | z_stick = z_slide | follows at the distance z_slide |
//! | stick, then oscillate | z_stick > z_slide | at z_stick jumps up to z_slide before the shaft, where α is 0: a stick |
//!
//! Fit: z_stick = Ts/k and z_slide = (2Tk − Ts)/k. This is the torque at which a
//! stick of the joint begins, and the mean at constant velocity is Tk. With
//! Ts = Tk the law slides.
//!
//! A cycle takes a travel of z_stick − z_slide = 2(Ts − Tk)/k. The law has no
//! inertia, so its slip takes no time, and it grates with Ω·k/(2(Ts − Tk)): above
//! the joint's frequency, whose slips last half a period and more. It is the
//! nearest that keeps both ends of the joint's torque.
//!
//! Source: V. Hayward, B. Armstrong, "A new computational model of friction
//! applied to haptic rendering", Experimental Robotics VI, Lecture Notes in
//! Control and Information Sciences 250, 2000, pp. 403–412, DOI
//! 10.1007/BFb0119418. Its α is any function of z; the step above is its
//! simplest one with all regimes.
//!
//! Discretisation, with y = |xₙ − xₙ₋₁| and z = xₙ − wₙ₋₁:
//!
//! ```text
//! |z| ≤ z_stick                  wₙ = wₙ₋₁
//! |z| > z_stick, α·|z| ≤ 1       wₙ = wₙ₋₁ + α·(xₙ − wₙ)·y              creep, implicit
//! |z| > z_stick, α·|z| > 1       |xₙ − wₙ| = z_slide + rest             slide, oscillation
//!
//! rest = (|z| − z_stick) modulo (z_stick − z_slide), 0 where that is not positive
//! ```
//!
//! With wₙ = xₙ ∓ z_slide alone, each cycle would be longer by the travel between
//! the break and the end of its step, up to Ω·h. With the rest, the cycles are
//! those of the continuous law at any step.
//!
//! Known traps:
//! - x and w grow with the travel, and in f32 their difference loses its digits:
//!   here T itself is summed, with compensation, which also keeps it when
//!   parameters change.
//! - For Tk < Ts/2 z_slide is negative: the point jumps beyond the shaft. No α
//!   does that (at Tk = Ts/2 it is infinite); the rule of the jump is the same.
//! - Noise of the angle is travel: in the creep regime it moves w.

use super::{Contact, FrictionLaw};
use crepitus_model::joint::compensated::Compensated;
use crepitus_model::{Real, ShaftStep};

/// Parameters of the law; the lengths as torques of its spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdhesionParameters {
    /// Stiffness k, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// k·z_stick: torque up to which the adhesion point rests, N·m.
    pub stick_nm: f64,
    /// k·z_slide: torque of steady sliding, or with which a stick begins, N·m.
    pub slide_nm: f64,
}

/// The law of Hayward and Armstrong.
#[derive(Clone, Copy, Debug)]
pub struct HaywardArmstrong<F> {
    /// T = k·z, N·m.
    torque: Compensated<F>,
    stiffness: F,
    stick_nm: F,
    slide_nm: F,
    /// α/k beyond z_stick, 1/(N·m).
    per_slide: F,
}

impl<F: Real> HaywardArmstrong<F> {
    /// Torque after the adhesion point has moved. `rise_nm` is the spring's share of the step.
    fn moved(&self, torque_nm: F, rise_nm: F) -> F {
        let size = torque_nm.abs();
        let left = if size <= self.slide_nm {
            size / (F::ONE + self.per_slide * rise_nm.abs())
        } else {
            let cycle = self.stick_nm - self.slide_nm;
            if cycle > F::ZERO {
                let over = size - self.stick_nm;
                // Hardly ever more than one break in a step.
                let rest = if over < cycle {
                    over
                } else {
                    over - F::from_whole((over / cycle).whole()) * cycle
                };
                (self.slide_nm + rest).within(self.stick_nm)
            } else {
                self.slide_nm
            }
        };
        if torque_nm < F::ZERO { -left } else { left }
    }

    fn set(&mut self, parameters: &AdhesionParameters) {
        self.stiffness = F::from_f64(parameters.stiffness_nm_per_rad);
        self.stick_nm = F::from_f64(parameters.stick_nm);
        self.slide_nm = F::from_f64(parameters.slide_nm);
        self.per_slide = if self.slide_nm > F::ZERO {
            F::from_f64(1.0 / parameters.slide_nm)
        } else {
            F::ZERO
        };
    }
}

impl<F: Real> FrictionLaw<F> for HaywardArmstrong<F> {
    type Parameters = AdhesionParameters;

    fn fitted(contact: &Contact) -> AdhesionParameters {
        AdhesionParameters {
            stiffness_nm_per_rad: contact.stiffness_nm_per_rad,
            stick_nm: contact.static_torque_nm,
            slide_nm: 2.0 * contact.kinetic_torque_nm - contact.static_torque_nm,
        }
    }

    fn new(parameters: &AdhesionParameters, _: f64) -> Self {
        let mut law = Self {
            torque: Compensated::new(F::ZERO),
            stiffness: F::ZERO,
            stick_nm: F::ZERO,
            slide_nm: F::ZERO,
            per_slide: F::ZERO,
        };
        law.set(parameters);
        law
    }

    /// The torque stays, held within what the law can bear from now on.
    fn change(&mut self, parameters: &AdhesionParameters, _: f64) {
        self.set(parameters);
        let largest = self.stick_nm.at_least(self.slide_nm);
        if self.torque.value().abs() > largest {
            self.torque = Compensated::new(self.torque.value().within(largest));
        }
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let rise_nm = self.stiffness * shaft.delta_phi_rad;
        self.torque.add(rise_nm);
        let torque_nm = self.torque.value();
        if torque_nm.abs() > self.stick_nm {
            self.torque = Compensated::new(self.moved(torque_nm, rise_nm));
        }
        self.torque.value()
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

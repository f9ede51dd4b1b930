//! Generalised Maxwell-slip friction: N springs in parallel, each with a slider.
//!
//! ```text
//!   stick   dFᵢ/dt = kᵢ·v                              until |Fᵢ| = αᵢ·s(v)
//!   slip    dFᵢ/dt = sgn(v)·C·(αᵢ − |Fᵢ|/s(v))         until v reverses
//!
//!   T = Σ Fᵢ + σ1(v)·v·(share of kᵢ in stick),    Σ αᵢ = 1,    s the Stribeck curve
//! ```
//!
//! V. Lampaert, F. Al-Bender, J. Swevers, "A generalized Maxwell-slip friction model appropriate
//! for control purposes", Physics and Control 2003, 1170–1177, DOI 10.1109/PHYCON.2003.1237071;
//! F. Al-Bender, V. Lampaert, J. Swevers, "The generalized Maxwell-slip model: a novel model for
//! friction simulation and compensation", IEEE Transactions on Automatic Control 50 (2005)
//! 1883–1887, DOI 10.1109/TAC.2005.858676. What the elements add is the hysteresis of presliding
//! with its memory: an inner loop closes, and the outer one goes on as if there had been none.
//!
//! # Fit
//! Equal stiffnesses kᵢ = σ0/N, and break angles δᵢ = i·δ that are linearly spaced. The sum of the
//! strengths kᵢ·δᵢ is Ts where δ = 2·Ts/(σ0·(N + 1)), so that αᵢ = 2·i/(N·(N + 1)). The first
//! loading is a polygon with corners on a parabola: stiffness σ0 up to δ, and Ts from
//! 2·N/(N + 1)·Ts/σ0 on.
//!
//! Attraction C = σ0·(Ts − Tk)/√(J·kr), σ0·vs/0.3 by the rule of the contact: an element goes to
//! its strength in sliding as quickly as the bristle of the LuGre law would at the velocity of the
//! object's swing. Where Ts = Tk the strength never changes, and it is reached at once. σ1(v) is in
//! `damping.rs`.
//!
//! # Discretisation
//! In a step s is constant, that of the mean velocity. Stick is an addition that ends at the
//! strength; slip is the exponential Fᵢ → αᵢ·s + (Fᵢ − αᵢ·s)·e^(−C·h/s), one for all elements.
//! With a constant s this is exact where the motion does not reverse within a step. Slip ends
//! where the travel is zero or reverses.
//!
//! # On the object
//! Just before the break one element of N is in stick, and the contact gets longer at
//! Ω·k/(k + σ0/N): Ω/26 with 4 elements, Ω/11 with 10. Where that is not small beside vs, the
//! strengths fall before the break. The damping of the elements in stick adds to them where the
//! contact springs back: the torque is up to 1.45·Ts there.
//!
//! # Traps
//! - In slip, time acts instead of travel: at a slow creep, torque rises to Ts in the time Ts/C.
//! - An element in stick whose strength falls below its torque, since the velocity has risen, begins
//!   its slip from there. Clipped at its strength instead, the torque would jump.
//! - A test of |Fᵢ| against the strength alone (no state of slip) makes slip elastic where s rises.
//! - Damping of an element's dF/dt in slip too, as some have it, turns the attraction where the
//!   motion comes to rest into torque far above Ts. Here damping acts in stick only.
//! - Presliding is stiff up to 2/(N + 1) of Ts/σ0 only; a tremor beyond that takes part of a load.
//! - In f32 the sum of an element in stick drifts by up to one rounding error a cycle of a tremor.

use super::damping::Damping;
use super::relaxation::share;
use super::stribeck::{Stribeck, divisible};
use super::{Contact, FrictionLaw};
use crepitus_model::{Real, ShaftStep};

/// Parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellSlipParameters {
    /// The contact: Ts, Tk, σ0, σ1 and vs.
    pub contact: Contact,
    /// Attraction C, N·m/s; infinite: the strength is reached at once.
    pub attraction_nm_per_s: f64,
}

/// The law with N elements.
#[derive(Clone, Copy, Debug)]
pub struct MaxwellSlip<F, const N: usize> {
    /// Torque of each element, from the weakest on, N·m.
    elements_nm: [F; N],
    /// Elements in slip.
    slips: [bool; N],
    /// Sense of the slip.
    is_forward: bool,
    /// Sum of the elements, N·m.
    elastic_nm: F,
    stiffness: F,
    /// 1/(σ0·h): velocity by change of the elastic torque in a step.
    per_change: F,
    curve: Stribeck<F>,
    damping: Damping<F>,
    /// 1/N.
    per_element: F,
    /// Strength of the weakest element beside s: 2/(N·(N + 1)).
    first_share: F,
    /// C·h, N·m.
    attraction_nm: F,
}

impl<F: Real, const N: usize> FrictionLaw<F> for MaxwellSlip<F, N> {
    type Parameters = MaxwellSlipParameters;

    fn fitted(contact: &Contact) -> Self::Parameters {
        let rate = contact.stiffness_nm_per_rad * contact.swing_rad_s();
        MaxwellSlipParameters {
            contact: *contact,
            attraction_nm_per_s: if rate > 0.0 { rate } else { f64::INFINITY },
        }
    }

    fn new(parameters: &Self::Parameters, step_s: f64) -> Self {
        let contact = &parameters.contact;
        let stiffness = contact.stiffness_nm_per_rad;
        // A sum, as there are few: no cast.
        let count: f64 = [1.0; N].iter().sum();
        Self {
            elements_nm: [F::ZERO; N],
            slips: [false; N],
            is_forward: false,
            elastic_nm: F::ZERO,
            stiffness: F::from_f64(stiffness),
            per_change: F::from_f64(1.0 / (stiffness * step_s)),
            curve: Stribeck::new(&divisible(contact)),
            damping: Damping::new(contact),
            per_element: F::from_f64(1.0 / count),
            first_share: F::from_f64(2.0 / (count * (count + 1.0))),
            attraction_nm: F::from_f64(parameters.attraction_nm_per_s * step_s),
        }
    }

    fn change(&mut self, parameters: &Self::Parameters, step_s: f64) {
        *self = Self {
            elements_nm: self.elements_nm,
            slips: self.slips,
            is_forward: self.is_forward,
            elastic_nm: self.elastic_nm,
            ..Self::new(parameters, step_s)
        };
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let travel_nm = self.stiffness * shaft.delta_phi_rad;
        let is_forward = travel_nm > F::ZERO;
        if travel_nm == F::ZERO || is_forward != self.is_forward {
            self.slips = [false; N];
            self.is_forward = is_forward;
        }
        if travel_nm == F::ZERO {
            return self.elastic_nm;
        }
        let omega = F::HALF * (shaft.omega_start_rad_s + shaft.omega_end_rad_s);
        let sliding_nm = self.curve.at(omega.abs());
        let share = share(self.attraction_nm / sliding_nm);
        let sense = if is_forward { F::ONE } else { -F::ONE };
        let (mut strength_nm, first_nm) = (F::ZERO, sliding_nm * self.first_share);
        let along_nm = travel_nm * sense * self.per_element;
        let (mut sum_nm, mut stuck_nm) = (F::ZERO, F::ZERO);
        for (torque_nm, slips) in self.elements_nm.iter_mut().zip(&mut self.slips) {
            strength_nm += first_nm;
            let from_nm = *torque_nm * sense;
            let to_nm = if *slips || from_nm > strength_nm {
                *slips = true;
                from_nm + (strength_nm - from_nm) * share
            } else {
                *slips = from_nm + along_nm > strength_nm;
                let to_nm = (from_nm + along_nm).at_most(strength_nm);
                stuck_nm += to_nm - from_nm;
                to_nm
            };
            *torque_nm = to_nm * sense;
            sum_nm += *torque_nm;
        }
        self.elastic_nm = sum_nm;
        if self.damping.is_none() {
            return sum_nm;
        }
        sum_nm + self.damping.at(omega) * (stuck_nm * sense * self.per_change)
    }
}

#[cfg(test)]
mod tests;

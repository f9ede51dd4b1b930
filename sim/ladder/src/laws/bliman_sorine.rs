//! Bliman and Sorine's second-order model: two Dahl elements of opposite signs.
//!
//! ```text
//! dx1/ds = a·(+f1·sgn(v) − x1)          T = x1 + x2          s: travel, always growing
//! dx2/ds = b·(−f2·sgn(v) − x2)          a > b: the slow one takes back what the fast one gave
//! ```
//!
//! P.-A. Bliman, M. Sorine, *Easy-to-use realistic dry friction models for automatic control*,
//! Proceedings of the 3rd European Control Conference, Rome, 1995, pp. 3788–3794.
//!
//! **Fit.** From rest T = Tk + f2·exp(−b·s) − f1·exp(−a·s). Three conditions, of four unknowns:
//!
//! ```text
//! f1 − f2 = Tk          f1·a − f2·b = σ0          max T = Ts
//! ```
//!
//! The fourth is b/a = 1/2. The larger it is, the sooner the torque falls after the peak, which is
//! what an object needs to slip; at the bound of 1 it falls little sooner than here, and for 1/2
//! the peak has a closed form: with D = Ts − Tk
//!
//! ```text
//! f2 = 2·(D + √(D·Ts))          a = σ0/(Tk + f2/2)          peak at a·s = 2·ln(2·f1/f2)
//! ```
//!
//! **Discretisation.** Exact in the travel of a step, as in [`super::dahl`]; a step in which the
//! shaft turns counts as its net travel. The law is rate independent to the bit.
//!
//! **On an object** it does not grate, seen on the paper's joint at 0.01 … 0.5 rad/s: after the first
//! peak the torque is Tk at every velocity, so that nothing drives the object's swing, and each
//! reversal of the contact takes from it. There is no entry for it.
//!
//! **Known traps.** The peak is Ts from rest; in a reversal of steady sliding it is 2·Ts − Tk, more
//! than any static torque, and no motion shows more. The torque falls with travel and not with
//! velocity: steady sliding is the same at every velocity. Presliding is soft: the peak comes at
//! about three times the travel Ts/σ0 of a spring. A varying load creeps, as in Dahl's model.

use super::relaxation::share;
use super::{Contact, FrictionLaw};
use crepitus_model::{Real, ShaftStep};

/// Parameters of [`BlimanSorine`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlimanSorineParameters {
    /// Level of the fast element f1, N·m.
    pub fast_nm: f64,
    /// Level of the slow element f2, N·m; it is subtracted.
    pub slow_nm: f64,
    /// Rate of the fast element a, 1/rad; that of the slow one is half of it.
    pub per_rad: f64,
}

/// Bliman and Sorine's model. Its state is the torques of its two elements.
#[derive(Clone, Copy, Debug)]
pub struct BlimanSorine<F> {
    fast_nm: F,
    slow_nm: F,
    fast_level_nm: F,
    slow_level_nm: F,
    /// b, 1/rad.
    per_rad: F,
}

impl BlimanSorineParameters {
    /// Largest torque of all motions, N·m: that in a reversal of steady sliding.
    ///
    /// T is an integral of the sign of the motion over the past travel. Its weight,
    /// f1·a·exp(−a·s) − f2·b·exp(−b·s), changes sign once: at the travel of the peak.
    fn largest_nm(&self) -> f64 {
        let kinetic_nm = self.fast_nm - self.slow_nm;
        // exp(−b·s) at the peak is f2/(2·f1).
        if self.slow_nm > 0.0 {
            kinetic_nm + self.slow_nm * self.slow_nm / (2.0 * self.fast_nm)
        } else {
            kinetic_nm
        }
    }
}

impl<F: Real> FrictionLaw<F> for BlimanSorine<F> {
    type Parameters = BlimanSorineParameters;

    fn fitted(contact: &Contact) -> Self::Parameters {
        let static_nm = contact.static_torque_nm;
        let kinetic_nm = contact.kinetic_torque_nm;
        let drop_nm = (static_nm - kinetic_nm).max(0.0);
        let slow_nm = 2.0 * (drop_nm + Real::sqrt(drop_nm * static_nm));
        let length_nm = kinetic_nm + 0.5 * slow_nm;
        BlimanSorineParameters {
            fast_nm: kinetic_nm + slow_nm,
            slow_nm,
            // Without levels there is no torque, and no travel changes that.
            per_rad: if length_nm > 0.0 {
                contact.stiffness_nm_per_rad / length_nm
            } else {
                0.0
            },
        }
    }

    fn new(parameters: &Self::Parameters, step_s: f64) -> Self {
        let mut law = Self {
            fast_nm: F::ZERO,
            slow_nm: F::ZERO,
            fast_level_nm: F::ZERO,
            slow_level_nm: F::ZERO,
            per_rad: F::ZERO,
        };
        law.change(parameters, step_s);
        law
    }

    /// The torque stays, or saturates at the largest that the new parameters show; both elements
    /// in proportion.
    fn change(&mut self, parameters: &Self::Parameters, _: f64) {
        self.fast_level_nm = F::from_f64(parameters.fast_nm);
        self.slow_level_nm = F::from_f64(parameters.slow_nm);
        self.per_rad = F::from_f64(0.5 * parameters.per_rad);
        let limit = F::from_f64(parameters.largest_nm());
        let torque = (self.fast_nm + self.slow_nm).abs();
        if torque > limit {
            let scale = limit / torque;
            self.fast_nm = self.fast_nm * scale;
            self.slow_nm = self.slow_nm * scale;
        }
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let travel = shaft.delta_phi_rad;
        let (fast, slow) = if travel < F::ZERO {
            (-self.fast_level_nm, self.slow_level_nm)
        } else {
            (self.fast_level_nm, -self.slow_level_nm)
        };
        let slow_share = share(travel.abs() * self.per_rad);
        // 1 − (1 − p)²: the fast element has twice the rate.
        let fast_share = slow_share * (F::TWO - slow_share);
        self.fast_nm += (fast - self.fast_nm) * fast_share;
        self.slow_nm += (slow - self.slow_nm) * slow_share;
        self.fast_nm + self.slow_nm
    }
}

#[cfg(test)]
mod tests;

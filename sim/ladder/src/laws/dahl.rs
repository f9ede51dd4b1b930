//! Dahl's model: bristles whose stiffness falls as they approach the sliding torque.
//!
//! ```text
//! dT/dx = σ0·(1 − sgn(ẋ)·T/Tc)                         exponent 1
//! ```
//!
//! P. R. Dahl, *A solid friction model*, The Aerospace Corporation, TOR-0158(3107-18)-1, 1968;
//! *Solid friction damping of mechanical vibrations*, AIAA Journal 14(12), 1976, pp. 1675–1682,
//! doi:10.2514/3.61511.
//!
//! **Fit.** σ0 is the presliding stiffness. The model has one level, which it approaches and never
//! exceeds: Tc = Tk, the torque of steady sliding. Ts has no place in it.
//!
//! **Discretisation.** Exact in the travel of a step, whatever its length:
//! T → s·Tc + (T − s·Tc)·exp(−σ0·|Δφ|/Tc), s the sign of Δφ. A step in which the shaft turns
//! counts as its net travel. Velocity and step do not enter: the law is rate independent to the
//! bit.
//!
//! **Known traps.** No break-away, so that an object on it never grates. A load below Tc creeps
//! under every vibration, as the stiffness is less on the way up than on the way down. An explicit
//! step of the equation diverges where σ0·|Δφ| > 2·Tc.

use super::relaxation::share;
use super::{Contact, FrictionLaw};
use crepitus_model::{Real, ShaftStep};

/// Parameters of [`Dahl`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DahlParameters {
    /// Presliding stiffness σ0, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Torque of steady sliding Tc, N·m.
    pub sliding_nm: f64,
}

/// Dahl's model. Its state is the torque.
#[derive(Clone, Copy, Debug)]
pub struct Dahl<F> {
    torque_nm: F,
    sliding_nm: F,
    /// σ0/Tc, 1/rad.
    per_travel: F,
}

impl<F: Real> FrictionLaw<F> for Dahl<F> {
    type Parameters = DahlParameters;

    fn fitted(contact: &Contact) -> Self::Parameters {
        DahlParameters {
            stiffness_nm_per_rad: contact.stiffness_nm_per_rad,
            sliding_nm: contact.kinetic_torque_nm,
        }
    }

    fn new(parameters: &Self::Parameters, step_s: f64) -> Self {
        let mut law = Self {
            torque_nm: F::ZERO,
            sliding_nm: F::ZERO,
            per_travel: F::ZERO,
        };
        law.change(parameters, step_s);
        law
    }

    /// The torque stays, or saturates at the new level.
    fn change(&mut self, parameters: &Self::Parameters, _: f64) {
        let p = parameters;
        // Without a level there is no torque, and no travel changes that.
        let per_travel = if p.sliding_nm > 0.0 {
            p.stiffness_nm_per_rad / p.sliding_nm
        } else {
            0.0
        };
        self.per_travel = F::from_f64(per_travel);
        self.sliding_nm = F::from_f64(p.sliding_nm);
        self.torque_nm = self.torque_nm.within(self.sliding_nm);
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let travel = shaft.delta_phi_rad;
        let level = if travel < F::ZERO {
            -self.sliding_nm
        } else {
            self.sliding_nm
        };
        self.torque_nm += (level - self.torque_nm) * share(travel.abs() * self.per_travel);
        self.torque_nm
    }
}

#[cfg(test)]
mod tests;

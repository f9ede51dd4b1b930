//! LuGre: bristles whose deflection is bounded by the Stribeck curve.
//!
//! ```text
//! ż = v − σ0·|v|/g(v)·z          T = σ0·z + σ1(v)·ż          σ2 = 0
//!
//! g(v) = Tk + (Ts − Tk)·exp(−(v/vs)²)          σ1(v) = σ1/(1 + (v/vd)²)
//! ```
//!
//! C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A new model for control of systems
//! with friction*, IEEE Transactions on Automatic Control 40(3), 1995, pp. 419–425,
//! doi:10.1109/9.376053.
//!
//! **Fit.** The state is u = σ0·z, N·m. σ0 is the contact's stiffness and g its Stribeck curve;
//! σ1(v) is in `damping.rs`. The velocity in g is that at which the bristles are loaded, too: in
//! stick on an object Ω/100. Where that is beyond vs, they are never loaded above Tk; where Ω is far
//! below vs, the sliding itself is at Ts. In neither case does the object grate.
//!
//! **Damping.** v·T − d(u²/2σ0)/dt is a quadratic form in ż and z that is non-negative for all z
//! just where σ1(v) ≤ 4·g(v)/|v|. Here T = (1 − λ)·u + λ·sgn(v)·g with λ = σ1(v)·|v|/g ≤ 1: no
//! velocity, however suddenly it comes, shows a torque above Ts. (With the exponential step; the
//! explicit one overshoots where σ0·|v|·h > g.)
//!
//! **Discretisation.** The travel of a step is Δφ, and a step in which the shaft turns counts as its
//! net travel; g and ż are those of its mean velocity.
//!
//! * [`LuGre`]: explicit Euler, u → u + σ0·(Δφ − |Δφ|·u/g), with ż at the start of the step.
//! * [`LuGreExponential`]: u → s·g + (u − s·g)·exp(−σ0·|Δφ|/g), s the sign of Δφ, with ż at its
//!   end. Exact where v is constant in the step; else of second order, its damping of first.
//!
//! **Known traps.** Explicit Euler diverges where σ0·|v|·h > 2·g(v): to infinity, and then to a NaN
//! that stays. On the object of the paper's joint in steps of 50 µs that is 0.2 rad/s of relative
//! velocity, which slips reach from a shaft of 0.1 rad/s on; with Tk = 0 it is any velocity well
//! beyond vs. A load below Ts that varies creeps (*drift*), as in Dahl's model: presliding is
//! plastic from the first. Break-away comes below Ts and falls with the rate of the load, because
//! g(v) is that of the bristles' velocity.

use super::damping::Damping;
use super::relaxation::share;
use super::stribeck::{Stribeck, divisible};
use super::{Contact, FrictionLaw};
use crepitus_model::{Real, ShaftStep};

/// LuGre by explicit Euler.
#[derive(Clone, Copy, Debug)]
pub struct LuGre<F>(Bristles<F>);

/// LuGre by an exponential step.
#[derive(Clone, Copy, Debug)]
pub struct LuGreExponential<F>(Bristles<F>);

/// State and coefficients of both.
#[derive(Clone, Copy, Debug)]
struct Bristles<F> {
    /// u = σ0·z, N·m.
    torque_nm: F,
    stiffness: F,
    damping: Damping<F>,
    curve: Stribeck<F>,
}

/// Motion of one step, and the torque of steady sliding in it.
struct Sliding<F> {
    travel_rad: F,
    omega_rad_s: F,
    level_nm: F,
    per_level: F,
}

impl<F: Real> Bristles<F> {
    fn new(contact: &Contact) -> Self {
        Self {
            torque_nm: F::ZERO,
            stiffness: F::from_f64(contact.stiffness_nm_per_rad),
            damping: Damping::new(contact),
            curve: Stribeck::new(&divisible(contact)),
        }
    }

    /// The torque of the bristles stays, or saturates at the new Ts; that of their damping
    /// follows.
    fn change(&mut self, contact: &Contact) {
        let changed = Self::new(contact);
        *self = Self {
            torque_nm: self.torque_nm.within(changed.curve.static_nm()),
            ..changed
        };
    }

    #[inline]
    fn sliding(&self, shaft: &ShaftStep<F>) -> Sliding<F> {
        let omega_rad_s = F::HALF * (shaft.omega_start_rad_s + shaft.omega_end_rad_s);
        let level_nm = self.curve.at(omega_rad_s.abs());
        Sliding {
            travel_rad: shaft.delta_phi_rad,
            omega_rad_s,
            level_nm,
            per_level: F::ONE / level_nm,
        }
    }

    /// σ1(v)·ż where the bristles bear `torque_nm`.
    #[inline]
    fn damping_nm(&self, sliding: &Sliding<F>, torque_nm: F) -> F {
        if self.damping.is_none() {
            return F::ZERO;
        }
        let omega = sliding.omega_rad_s;
        let weight = self.damping.at(omega) * omega.abs() * sliding.per_level;
        weight * (sliding.level(omega) - torque_nm)
    }
}

impl<F: Real> Sliding<F> {
    /// The level with the sign of a motion.
    #[inline]
    fn level(&self, motion: F) -> F {
        if motion < F::ZERO {
            -self.level_nm
        } else {
            self.level_nm
        }
    }
}

impl<F: Real> FrictionLaw<F> for LuGre<F> {
    type Parameters = Contact;

    fn fitted(contact: &Contact) -> Contact {
        *contact
    }

    fn new(parameters: &Contact, _: f64) -> Self {
        Self(Bristles::new(parameters))
    }

    fn change(&mut self, parameters: &Contact, _: f64) {
        self.0.change(parameters);
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let bristles = &mut self.0;
        let sliding = bristles.sliding(shaft);
        let before_nm = bristles.torque_nm;
        let travel = sliding.travel_rad;
        let yielded = travel.abs() * before_nm * sliding.per_level;
        bristles.torque_nm += bristles.stiffness * (travel - yielded);
        bristles.torque_nm + bristles.damping_nm(&sliding, before_nm)
    }
}

impl<F: Real> FrictionLaw<F> for LuGreExponential<F> {
    type Parameters = Contact;

    fn fitted(contact: &Contact) -> Contact {
        *contact
    }

    fn new(parameters: &Contact, _: f64) -> Self {
        Self(Bristles::new(parameters))
    }

    fn change(&mut self, parameters: &Contact, _: f64) {
        self.0.change(parameters);
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let bristles = &mut self.0;
        let sliding = bristles.sliding(shaft);
        let travel = sliding.travel_rad;
        let share = share(bristles.stiffness * travel.abs() * sliding.per_level);
        bristles.torque_nm += (sliding.level(travel) - bristles.torque_nm) * share;
        bristles.torque_nm + bristles.damping_nm(&sliding, bristles.torque_nm)
    }
}

#[cfg(test)]
mod tests;

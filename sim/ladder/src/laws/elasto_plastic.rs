//! Elasto-plastic friction: a bristle that is elastic up to a break-away deflection.
//!
//! ```text
//! ż = v·(1 − α(z, v)·z/z_ss(v))            z_ss(v) = sgn(v)·g(v)/σ0,  g the Stribeck curve
//! T = σ0·z + σ1(v)·ż
//!
//!     α = 0                                where z and v differ in sign, or |z| ≤ |z_ba|
//!     α = ½ + ½·sin(π·(z − (z_max + z_ba)/2)/(z_max − z_ba))               in between
//!     α = 1                                where |z| ≥ |z_max|
//! ```
//!
//! P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, "Single state elastoplastic friction models",
//! IEEE Transactions on Automatic Control 47 (2002) 787–792, DOI 10.1109/TAC.2002.1000274. What
//! they add to the LuGre law is α: below z_ba a deflection is given back entirely, so that a load
//! does not creep under a tremor.
//!
//! # Fit
//! z_max = `z_ss(v)`, as published, and z_ba = 0.9·`z_ss(v)`: the upper end of the usual shares,
//! 0.7 to 0.9, as the stick of the joint is elastic up to Ts. σ0, σ1 and g are those of the
//! contact; σ1 falls with the velocity, see `damping.rs`.
//!
//! # Discretisation
//! The state is the elastic torque σ0·z, so that other parameters leave the torque as it is. In a
//! step g is constant, that of the mean velocity. With u = |z|/z_ss along the motion and the travel
//! s = |Δφ|/z_ss, the law is du/ds = f(u) = 1 − α(u)·u, whatever the parameters. Three parts:
//!
//! - up to u = 0.9 the step is exact: an addition, whose rounding error is carried on;
//! - beyond u = 1 it is exact: an exponential;
//! - between, one step of the exponential Rosenbrock–Euler method, of second order,
//!   u + s·f·φ(s·f′) with φ(x) = (eˣ − 1)/x, not beyond u = 1, which the law reaches from below
//!   in the limit only. It is stable for any travel.
//!
//! # On the object
//! In stick the contact gets longer at Ω·k/(k + σ0), a hundredth of the shaft's velocity. Where that
//! is not small beside vs, g has fallen before the bristle gives way, and the break drops less: at
//! 2 rad/s, from 0.33 N·m of the bristle where Ts is 0.4 N·m. The bristle is elastic where the
//! contact springs back, so that its damping adds to it: the torque is up to 1.4·Ts there.
//!
//! # Traps
//! - f′ is up to −π·0.95/(2·0.1) − 0.5 ≈ −15: explicit steps with more than 2/15 of z_ss a step
//!   oscillate. On the object one step of 50 µs at 1 rad/s is 10 z_ss.
//! - A step that is not small beside z_ss − z_ba sees little of the blend. The torque is then wrong by at
//!   most the rest of the way, 0.1·g.
//! - Break-away depends on the rate: at velocities far above vs the torque never exceeds Tk.
//! - z_ba falls with `z_ss(v)`: a load above 0.9·Tk is borne without a drift only while the
//!   tremor on it is slow beside vs.
//! - In f32 a plain sum drifts by up to one rounding error a cycle, 0.003 N·m in 100,000 cycles. What
//!   remains here is the rounding of the travels themselves, 2·10⁻⁴ N·m.
//! - Time does not act on it: at rest the torque stays, and only travel relaxes it.

use super::damping::Damping;
use super::relaxation::mean;
use super::stribeck::{Stribeck, divisible};
use super::{Contact, FrictionLaw};
use crepitus_model::joint::compensated::Compensated;
use crepitus_model::{Real, ShaftStep};

/// The elastic share of the deflection: `z_ba/z_ss`.
const ELASTIC_SHARE: f64 = 0.9;

/// Parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElastoPlasticParameters {
    /// The contact: Ts, Tk, σ0, σ1 and vs.
    pub contact: Contact,
    /// Elastic share of the deflection, `z_ba/z_ss`; from 0 to below 1.
    pub elastic_share: f64,
}

/// The law.
#[derive(Clone, Copy, Debug)]
pub struct ElastoPlastic<F> {
    /// Elastic torque σ0·z, N·m.
    elastic_nm: Compensated<F>,
    stiffness: F,
    /// 1/(σ0·h): velocity by change of the elastic torque in a step.
    per_change: F,
    curve: Stribeck<F>,
    damping: Damping<F>,
    blend: Blend<F>,
}

/// The flow du/ds = 1 − α(u)·u.
#[derive(Clone, Copy, Debug)]
struct Blend<F> {
    /// Begin of the plastic part: `z_ba/z_ss`.
    from: F,
    /// π/(1 − from).
    pi_per_width: F,
}

impl<F: Real> Blend<F> {
    fn new(elastic_share: f64) -> Self {
        Self {
            from: F::from_f64(elastic_share),
            pi_per_width: F::from_f64(core::f64::consts::PI / (1.0 - elastic_share)),
        }
    }

    /// Moves the deflection u over a travel s ≥ 0 that ends beyond the elastic part.
    #[inline]
    fn flow(&self, u: F, s: F) -> F {
        if u >= F::ONE {
            return F::ONE + (u - F::ONE) * (-s).exp();
        }
        let start = u.at_least(self.from);
        let rest = s - (start - u);
        let (sin, cos) = ((start - self.from) * self.pi_per_width).sin_cos();
        let alpha = F::HALF * (F::ONE - cos);
        let alpha_slope = F::HALF * self.pi_per_width * sin;
        let rate = F::ONE - alpha * start;
        let fall = alpha + alpha_slope * start;
        (start + rest * rate * mean(rest * fall)).at_most(F::ONE)
    }
}

impl<F: Real> FrictionLaw<F> for ElastoPlastic<F> {
    type Parameters = ElastoPlasticParameters;

    fn fitted(contact: &Contact) -> Self::Parameters {
        ElastoPlasticParameters {
            contact: *contact,
            elastic_share: ELASTIC_SHARE,
        }
    }

    fn new(parameters: &Self::Parameters, step_s: f64) -> Self {
        let contact = &parameters.contact;
        let stiffness = contact.stiffness_nm_per_rad;
        Self {
            elastic_nm: Compensated::new(F::ZERO),
            stiffness: F::from_f64(stiffness),
            per_change: F::from_f64(1.0 / (stiffness * step_s)),
            curve: Stribeck::new(&divisible(contact)),
            damping: Damping::new(contact),
            blend: Blend::new(parameters.elastic_share),
        }
    }

    fn change(&mut self, parameters: &Self::Parameters, step_s: f64) {
        *self = Self {
            elastic_nm: self.elastic_nm,
            ..Self::new(parameters, step_s)
        };
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        let travel_nm = self.stiffness * shaft.delta_phi_rad;
        if travel_nm == F::ZERO {
            return self.elastic_nm.value();
        }
        let omega = F::HALF * (shaft.omega_start_rad_s + shaft.omega_end_rad_s);
        let sliding_nm = self.curve.at(omega.abs());
        // The sense of the motion is in the sign: u and s are along it.
        let scale_nm = if travel_nm < F::ZERO {
            -sliding_nm
        } else {
            sliding_nm
        };
        let before_nm = self.elastic_nm.value();
        let (u, s) = (before_nm / scale_nm, travel_nm / scale_nm);
        if u + s <= self.blend.from {
            self.elastic_nm.add(travel_nm);
        } else {
            self.elastic_nm = Compensated::new(scale_nm * self.blend.flow(u, s));
        }
        let elastic_nm = self.elastic_nm.value();
        if self.damping.is_none() {
            return elastic_nm;
        }
        let rate = (elastic_nm - before_nm) * self.per_change;
        elastic_nm + self.damping.at(omega) * rate
    }
}

#[cfg(test)]
mod tests;

//! Coulomb friction, regularised so that it is a function of velocity.
//!
//! ```text
//! Tanh    T = g(Ω)·tanh(Ω/v)             Band    T = g(Ω)·Ω/v within ±v, ±g(Ω) beyond
//!
//!         g(Ω) = Tk + (Ts − Tk)·exp(−(Ω/vs)²)                      v = vs/10
//! ```
//!
//! Sources: common practice, reviewed by E. Pennestrì, V. Rossi, P. Salvini, P. P. Valentini,
//! Nonlinear Dynamics 83, 1785–1801, 2016, DOI 10.1007/s11071-015-2485-3. The curve g is that
//! of [`stribeck`](super::stribeck).
//!
//! **Fit.** v has to be small beside vs: at v = vs the peak of g·tanh is 0.52 Ts where
//! Ts = 2·Tk, no torque falls with velocity, and nothing could grate. At v = vs/10 the peak
//! is 0.957 Ts with tanh, and 0.995 Ts with the band. A contact with Ts = Tk has vs = 0: then
//! v is [`NARROWEST_RAD_S`].
//!
//! **Discretisation.** The law has no state, so a step is one evaluation. A controller applies
//! what it returns from the end of the step on, so Ω is the velocity at the end. The mean of
//! the step would be half a step old; the start a whole one.
//!
//! **Cost.** One exponential below 4 vs, and one for tanh between 2 v (in f32) and 9 v; none
//! beyond both: a steady slide costs comparisons.
//!
//! **Traps.** 1. No presliding: at rest the law bears nothing. Under a load L ≤ Tk without a
//! drop it creeps with v·artanh(L/Tk), or v·L/Tk in the band, for as long as the load is
//! there. 2. The slope at rest is a damping Ts/v. An inertia J that it acts on in explicit
//! steps needs h < 2·J·v/Ts = 0.06·(1 − Tk/Ts)·√(J/k), 150 µs for the joint of the paper; beyond,
//! the torque alternates from step to step. 3. g knows no direction of time: where a slip ends, the
//! torque rises to Ts and falls again before the stick begins. On an object this ends a slip early
//! and breaks a stick late: the joint of the paper grates 11 % slower with the band and 8 % slower
//! with tanh at 0.05 rad/s, and 0.1 % slower at 1 rad/s.

use super::stribeck::Stribeck;
use super::{Contact, FrictionLaw};
use crepitus_model::{Real, ShaftStep};

/// The width v beside the Stribeck velocity.
const WIDTH_SHARE: f64 = 0.1;

/// The smallest width v, rad/s: far below any motion of a hand.
pub const NARROWEST_RAD_S: f64 = 1e-6;

/// Parameters of both forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombParameters {
    /// The contact: Ts, Tk and vs.
    pub contact: Contact,
    /// Velocity v of the regularisation, rad/s; less than [`NARROWEST_RAD_S`] counts as that.
    pub width_rad_s: f64,
}

impl CoulombParameters {
    /// v = vs/10.
    fn fitted(contact: &Contact) -> Self {
        Self {
            contact: *contact,
            width_rad_s: WIDTH_SHARE * contact.stribeck_rad_s,
        }
    }
}

/// The curve, and 1/v.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Regularised<F> {
    curve: Stribeck<F>,
    per_width: F,
}

impl<F: Real> Regularised<F> {
    fn new(parameters: &CoulombParameters) -> Self {
        let width_rad_s = parameters.width_rad_s.max(NARROWEST_RAD_S);
        Self {
            curve: Stribeck::new(&parameters.contact),
            per_width: F::from_f64(1.0 / width_rad_s),
        }
    }

    /// g(Ω)·`shape`(Ω/v), with the sign of Ω.
    #[inline]
    fn torque_nm(&self, omega_rad_s: F, shape: impl FnOnce(F) -> F) -> F {
        let speed_rad_s = omega_rad_s.abs();
        let torque_nm = self.curve.at(speed_rad_s) * shape(speed_rad_s * self.per_width);
        if omega_rad_s < F::ZERO {
            -torque_nm
        } else {
            torque_nm
        }
    }
}

/// tanh x for x ≥ 0, to two units in the last place.
///
/// Near zero (1 − e)/(1 + e) would cancel: there it is the seventh convergent of Lambert's
/// continued fraction, within 2e-16 up to 1/2 and 1.2e-8 up to 2.
#[inline]
fn tanh<F: Real>(x: F) -> F {
    let f = F::from_f64;
    let (near, one_from) = if F::IS_SINGLE {
        (2.0, 9.02)
    } else {
        (0.5, 19.1)
    };
    if x < f(near) {
        let z = x * x;
        let over = f(135_135.0) + z * (f(17_325.0) + z * (f(378.0) + z));
        let under = f(135_135.0) + z * (f(62_370.0) + z * (f(3_150.0) + z * f(28.0)));
        x * over / under
    } else if x < f(one_from) {
        let e = (-(x + x)).exp();
        (F::ONE - e) / (F::ONE + e)
    } else {
        F::ONE
    }
}

/// Regularisation by tanh.
#[derive(Clone, Copy, Debug)]
pub struct Tanh<F>(Regularised<F>);

/// Regularisation by a velocity band.
#[derive(Clone, Copy, Debug)]
pub struct Band<F>(Regularised<F>);

macro_rules! regularised {
    ($law:ident, $shape:expr) => {
        impl<F: Real> FrictionLaw<F> for $law<F> {
            type Parameters = CoulombParameters;

            fn fitted(contact: &Contact) -> Self::Parameters {
                CoulombParameters::fitted(contact)
            }

            fn new(parameters: &Self::Parameters, _: f64) -> Self {
                Self(Regularised::new(parameters))
            }

            fn change(&mut self, parameters: &Self::Parameters, _: f64) {
                self.0 = Regularised::new(parameters);
            }

            #[inline]
            fn step(&mut self, shaft: &ShaftStep<F>) -> F {
                self.0.torque_nm(shaft.omega_end_rad_s, $shape)
            }
        }
    };
}

regularised!(Tanh, tanh);
regularised!(Band, |x| x.at_most(F::ONE));

#[cfg(test)]
mod tests;

//! The rungs of the solver ladder by name, and what each is made of.
//!
//! A program that knows its solver at build time names the types itself
//! (`Frozen<f32, ExactEvents>`) and links nothing else. A program that learns
//! it from a scene calls [`with_joint`], which decides once and runs the
//! visitor with the concrete type: no choice is left for the step.

use crate::active::Active;
use crate::frozen::Frozen;
use crate::locate::{EndOfStep, ExactEvents, Locate};
use crate::propagate::{Exact, Propagate};
use crate::real::Real;
use crate::settings::{Convention, Settings, SettingsError, Validated};
use crate::stick_slip::StickSlip;
use crate::velocity_match::{Paper, Physical, VelocityMatch};

/// A rung of the ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Solver {
    /// Exact propagator, switching at the end of the step: first order.
    Exact,
    /// Exact propagator, both events located exactly inside the step.
    ExactEvents,
}

impl Solver {
    /// All rungs, from the cheapest.
    pub const ALL: [Self; 2] = [Self::Exact, Self::ExactEvents];

    /// Why this rung has no meaning under a convention, if it has none.
    pub fn refusal(self, _convention: Convention) -> Option<&'static str> {
        None
    }

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::ExactEvents => "exact-events",
        }
    }
}

/// What to do with a joint once its type is known.
pub trait JointVisitor<F: Real> {
    /// What it gives back.
    type Output;

    /// Called with the joint.
    fn visit<J: StickSlip<F>>(self, joint: J) -> Self::Output;
}

/// Builds the joint that `settings` and `solver` describe, in stick at θ = 0
/// on a shaft that moves with `omega_rad_s`, and hands it to `visitor`.
///
/// # Errors
/// [`SettingsError::Step`] if the step is not positive and finite.
pub fn with_joint<F: Real, V: JointVisitor<F>>(
    settings: &Validated<Settings>,
    solver: Solver,
    step_s: f64,
    omega_rad_s: F,
    visitor: V,
) -> Result<V::Output, SettingsError> {
    let active = Active::new(settings, step_s)?;
    Ok(match solver {
        Solver::Exact => {
            rung::<F, Exact<F>, EndOfStep, V>(settings.convention, active, omega_rad_s, visitor)
        }
        Solver::ExactEvents => {
            rung::<F, Exact<F>, ExactEvents, V>(settings.convention, active, omega_rad_s, visitor)
        }
    })
}

/// One rung under the convention asked for.
fn rung<F: Real, P: Propagate<F>, L: Locate<F>, V: JointVisitor<F>>(
    convention: Convention,
    active: Active<F>,
    omega_rad_s: F,
    visitor: V,
) -> V::Output {
    match convention {
        Convention::Frozen => visitor.visit(Frozen::<F, L>::new(active, omega_rad_s)),
        Convention::Paper => {
            visitor.visit(VelocityMatch::<F, Paper, P, L>::new(active, omega_rad_s))
        }
        Convention::Physical => {
            visitor.visit(VelocityMatch::<F, Physical, P, L>::new(active, omega_rad_s))
        }
    }
}

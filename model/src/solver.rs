//! The rungs of the solver ladder by name, and the parts of each.
//!
//! A program that knows its solver at build time names the types itself
//! (`Frozen<f32, ExactEvents>`) and links nothing else. A program that learns
//! it from a scene calls [`with_joint`], which decides once and runs the
//! visitor with the concrete type: no choice is left for the step.

pub mod frozen;
pub mod implicit_euler;
pub mod locate;
pub mod propagate;
pub mod velocity_match;

use crate::joint::shaft::Linear;
use crate::joint::{Convention, Settings, SettingsError, StepCoefficients, StickSlip, Validated};
use crate::real::Real;
use crate::solver::frozen::Frozen;
use crate::solver::implicit_euler::ImplicitEuler;
use crate::solver::locate::{
    EndOfStep, ExactBreak, ExactEvents, ExactHermite, Interpolated, Locate,
};
use crate::solver::propagate::{Euler, Exact, Propagate, Rk4, SemiImplicitEuler, Verlet};
use crate::solver::velocity_match::{Paper, Physical, StickTorque, VelocityMatch};

crate::named! {
    /// A rung of the ladder: how a slip is carried forward, and how the end of a
    /// phase is found.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Solver {
        /// Explicit Euler, switching at the end of the step.
        Euler => "euler",
        /// Semi-implicit Euler, switching at the end of the step.
        SemiImplicitEuler => "semi-implicit-euler",
        /// Velocity Verlet, switching at the end of the step.
        Verlet => "verlet",
        /// Runge-Kutta of fourth order, switching at the end of the step.
        Rk4 => "rk4",
        /// Set-valued backward Euler: decides and propagates in one.
        ImplicitEuler => "implicit-euler",
        /// Exact propagator, switching at the end of the step.
        Exact => "exact",
        /// Exact propagator, the break located inside the step.
        ExactBreak => "exact-break",
        /// Exact propagator, both events by one interpolation.
        ExactInterpolated => "exact-interpolated",
        /// Exact propagator, both events located exactly.
        ExactEvents => "exact-events",
        /// Runge-Kutta of fourth order, both events located.
        Rk4Events => "rk4-events",
        /// Exact propagator, both events located on the shaft's cubic path; f64
        /// only, and on exact angles only.
        ExactHermite => "exact-hermite",
    }
}

impl Solver {
    /// Reason why this rung has no meaning under a convention; `None` where it has a meaning.
    pub fn refusal(self, convention: Convention) -> Option<&'static str> {
        match (self, convention) {
            (
                Self::Euler
                | Self::SemiImplicitEuler
                | Self::Verlet
                | Self::Rk4
                | Self::ImplicitEuler
                | Self::Rk4Events,
                Convention::Frozen,
            ) => Some(
                "under \"frozen\" a slip lasts a known time and is not integrated, so a method of \
                 integration has nothing to do; the rungs that differ in how the break is found are \
                 exact, exact-break, exact-interpolated and exact-events",
            ),
            (Self::ImplicitEuler, Convention::Paper) => Some(
                "the set-valued step needs the object's inertia in the torque of a stick, which \
                 \"paper\" leaves out; use \"physical\"",
            ),
            (Self::ExactHermite, Convention::Frozen) => Some(
                "under \"frozen\" the torque of a stick has no acceleration of the shaft in it, and \
                 exact-events is of second order already",
            ),
            _ => None,
        }
    }

    /// Reason why this rung cannot compute in f32; `None` if it can.
    pub fn single_refusal(self) -> Option<&'static str> {
        (self == Self::ExactHermite).then_some(
            "the shaft's acceleration comes from its travel over the step squared; in f32 rounding makes \
             1e-2 rad/s² of that at 50 µs and 1 rad/s, a hundred times what the cubic path corrects on a hand's \
             motion; use precision \"f64\"",
        )
    }

    /// Reason why this rung cannot compute in F under a convention; `None` if it can.
    pub fn refusal_in<F: Real>(self, convention: Convention) -> Option<&'static str> {
        self.refusal(convention)
            .or_else(|| self.single_refusal().filter(|_| F::IS_SINGLE))
    }

    /// Returns whether this rung needs the prescribed motion itself: an encoder's
    /// counts, or the rounding of a plant's integration, it would take for
    /// acceleration.
    pub fn needs_exact_motion(self) -> bool {
        self == Self::ExactHermite
    }
}

/// Work on a joint of a concrete type.
pub trait JointVisitor<F: Real> {
    /// Result of the visit.
    type Output;

    /// Called with the joint.
    fn visit<J: StickSlip<F> + Clone>(self, joint: J) -> Self::Output;
}

/// Builds the joint that `settings` and `solver` describe, in stick at θ = 0
/// on a shaft that moves with `omega_rad_s`, and hands it to `visitor`.
///
/// # Errors
/// [`SettingsError::Step`] if the step is not positive and finite,
/// [`SettingsError::Solver`] if the rung has no meaning under the convention,
/// or cannot compute in F.
pub fn with_joint<F: Real, V: JointVisitor<F>>(
    settings: &Validated<Settings>,
    solver: Solver,
    step_s: f64,
    omega_rad_s: F,
    visitor: V,
) -> Result<V::Output, SettingsError> {
    let start = Start {
        coefficients: StepCoefficients::new(settings, step_s)?,
        omega_rad_s,
    };
    let refused = |reason| SettingsError::Solver {
        solver: solver.name(),
        reason,
    };
    if let Some(reason) = solver.refusal_in::<F>(settings.convention) {
        return Err(refused(reason));
    }
    Ok(match settings.convention {
        Convention::Frozen => with_frozen_locator(solver, Begun { start, visitor }),
        Convention::Paper => start.velocity_match::<Paper, V>(solver, visitor),
        Convention::Physical => start.velocity_match::<Physical, V>(solver, visitor),
    })
}

/// Work that is generic over how `frozen` finds its events.
pub trait LocatorVisitor<F: Real> {
    /// Result of the visit.
    type Output;

    /// Called with the locator as a type.
    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output;
}

/// Visits with the locator of a rung under `frozen`; at the end of the step for one that is
/// [refused](Solver::refusal) there.
pub fn with_frozen_locator<F: Real, V: LocatorVisitor<F>>(solver: Solver, visitor: V) -> V::Output {
    match solver {
        Solver::ExactBreak => visitor.visit::<ExactBreak>(),
        Solver::ExactInterpolated => visitor.visit::<Interpolated>(),
        Solver::ExactEvents => visitor.visit::<ExactEvents>(),
        Solver::Exact
        | Solver::Euler
        | Solver::SemiImplicitEuler
        | Solver::Verlet
        | Solver::Rk4
        | Solver::ImplicitEuler
        | Solver::Rk4Events
        | Solver::ExactHermite => visitor.visit::<EndOfStep>(),
    }
}

/// A joint of `frozen`, but for its locator.
struct Begun<F, V> {
    start: Start<F>,
    visitor: V,
}

impl<F: Real, V: JointVisitor<F>> LocatorVisitor<F> for Begun<F, V> {
    type Output = V::Output;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> V::Output {
        let Start {
            coefficients,
            omega_rad_s,
        } = self.start;
        self.visitor
            .visit(Frozen::<F, L>::new(coefficients, omega_rad_s))
    }
}

/// Initial state of every joint.
struct Start<F> {
    coefficients: StepCoefficients<F>,
    omega_rad_s: F,
}

impl<F: Real> Start<F> {
    fn velocity_match<C: StickTorque<F>, V: JointVisitor<F>>(
        self,
        solver: Solver,
        visitor: V,
    ) -> V::Output {
        match solver {
            Solver::Euler => self.rung::<C, Euler<F>, EndOfStep, V>(visitor),
            Solver::SemiImplicitEuler => {
                self.rung::<C, SemiImplicitEuler<F>, EndOfStep, V>(visitor)
            }
            Solver::Verlet => self.rung::<C, Verlet<F>, EndOfStep, V>(visitor),
            Solver::Rk4 => self.rung::<C, Rk4<F>, EndOfStep, V>(visitor),
            Solver::ImplicitEuler => {
                visitor.visit(ImplicitEuler::new(self.coefficients, self.omega_rad_s))
            }
            Solver::Exact => self.rung::<C, Exact<F>, EndOfStep, V>(visitor),
            Solver::ExactBreak => self.rung::<C, Exact<F>, ExactBreak, V>(visitor),
            Solver::ExactInterpolated => self.rung::<C, Exact<F>, Interpolated, V>(visitor),
            // `ExactHermite` is refused in f32, so that no firmware links it.
            Solver::ExactHermite if !F::IS_SINGLE => {
                self.rung::<C, Exact<F>, ExactHermite, V>(visitor)
            }
            Solver::ExactEvents | Solver::ExactHermite => {
                self.rung::<C, Exact<F>, ExactEvents, V>(visitor)
            }
            Solver::Rk4Events => self.rung::<C, Rk4<F>, ExactEvents, V>(visitor),
        }
    }

    fn rung<C: StickTorque<F>, P: Propagate<F>, L: Locate<F>, V: JointVisitor<F>>(
        self,
        visitor: V,
    ) -> V::Output {
        visitor.visit(VelocityMatch::<F, C, P, L>::new(
            self.coefficients,
            self.omega_rad_s,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_files() {
        assert_eq!(
            Solver::ALL.map(Solver::name),
            [
                "euler",
                "semi-implicit-euler",
                "verlet",
                "rk4",
                "implicit-euler",
                "exact",
                "exact-break",
                "exact-interpolated",
                "exact-events",
                "rk4-events",
                "exact-hermite",
            ]
        );
    }

    #[test]
    fn a_rung_is_refused_where_it_has_no_meaning() {
        let refused = |convention| {
            Solver::ALL.map(|solver| {
                let reason = solver.refusal(convention);
                assert!(reason.is_none_or(|why| !why.is_empty()));
                u8::from(reason.is_some())
            })
        };
        // `frozen` integrates nothing, `paper` leaves out the inertia.
        assert_eq!(
            refused(Convention::Frozen),
            [1, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1]
        );
        assert_eq!(
            refused(Convention::Paper),
            [0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0]
        );
        assert_eq!(refused(Convention::Physical), [0; 11]);
    }

    struct Never;
    impl<F: Real> JointVisitor<F> for Never {
        type Output = ();
        fn visit<J: StickSlip<F>>(self, _: J) {}
    }

    #[test]
    fn the_cubic_path_is_refused_in_single_precision_alone() {
        for solver in Solver::ALL {
            let is_hermite = solver == Solver::ExactHermite;
            let single = solver.refusal_in::<f32>(Convention::Physical);
            assert_eq!(single.is_some(), is_hermite, "{solver:?}");
            assert_eq!(solver.refusal_in::<f64>(Convention::Physical), None);
            assert_eq!(solver.needs_exact_motion(), is_hermite);
        }
        let settings = Settings {
            convention: Convention::Physical,
            ..Settings::default()
        };
        let settings = settings.validate().unwrap();
        let built = with_joint::<f32, _>(&settings, Solver::ExactHermite, 5e-5, 0.0, Never);
        assert!(matches!(
            built,
            Err(SettingsError::Solver {
                solver: "exact-hermite",
                ..
            })
        ));
        assert!(with_joint::<f64, _>(&settings, Solver::ExactHermite, 5e-5, 0.0, Never).is_ok());
    }
}

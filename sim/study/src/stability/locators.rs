//! The four rungs of `frozen`, whose joint a device changes while it runs:
//! such a joint is built by its own type and not by its rung's name.

use super::subject::{Rung, Subject};
use crepitus_model::Real;
use crepitus_model::joint::shaft::Linear;
use crepitus_model::solver::Solver;
use crepitus_model::solver::locate::{EndOfStep, ExactBreak, ExactEvents, Interpolated, Locate};

/// Work that is generic over the locator.
pub(super) trait WithLocator<F: Real> {
    /// Its result.
    type Output;

    /// Called with the locator as a type.
    fn run<L: Locate<F, Shape = Linear>>(self) -> Self::Output;
}

/// Runs with the locator of a rung of `frozen`.
pub(super) fn with_locator<F: Real, W: WithLocator<F>>(subject: Subject, with: W) -> W::Output {
    match subject.solver {
        Rung::Ladder(Solver::ExactBreak) => with.run::<ExactBreak>(),
        Rung::Ladder(Solver::ExactInterpolated) => with.run::<Interpolated>(),
        Rung::Ladder(Solver::ExactEvents) => with.run::<ExactEvents>(),
        // But for `exact` they are refused under `frozen`, or have no joint.
        Rung::Reference
        | Rung::Ladder(
            Solver::Exact
            | Solver::Euler
            | Solver::SemiImplicitEuler
            | Solver::Verlet
            | Solver::Rk4
            | Solver::ImplicitEuler
            | Solver::Rk4Events
            | Solver::ExactHermite,
        ) => with.run::<EndOfStep>(),
    }
}

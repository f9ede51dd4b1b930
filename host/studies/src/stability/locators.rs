//! The four rungs of `frozen`, whose joint a device changes while it runs:
//! such a joint is built by its own type and not by its rung's name.

use super::subject::{Rung, Subject};
use crepitus_model::Real;
use crepitus_model::solver::{LocatorVisitor, Solver, with_frozen_locator};

/// Visits with the locator of a rung of `frozen`; the reference has no such joint.
pub(super) fn with_locator<F: Real, V: LocatorVisitor<F>>(
    subject: Subject,
    visitor: V,
) -> V::Output {
    let solver = match subject.solver {
        Rung::Ladder(solver) => solver,
        Rung::Reference => Solver::Exact,
    };
    with_frozen_locator(solver, visitor)
}

//! Propagation of a slip: one file a rung of the ladder.
//!
//! A propagator knows nothing of phases and events; a
//! [locator](crate::solver::locate) knows nothing of the method that moves the object.

mod euler;
mod exact;
mod rk4;
mod semi_implicit_euler;
mod verlet;

pub use euler::Euler;
pub use exact::Exact;
pub use rk4::Rk4;
pub use semi_implicit_euler::SemiImplicitEuler;
pub use verlet::Verlet;

use crate::joint::StepCoefficients;
use crate::joint::oscillator::Transition;
use crate::real::Real;

/// Moves the object through a slip: J·ẍ + c·ẋ + kr·x = 0 with
/// x = θ − s·Tk/kr and v = ẋ.
pub trait Propagate<F: Real>: Copy + Send + 'static {
    /// The propagator for the parameters and the step of `coefficients`.
    fn new(coefficients: &StepCoefficients<F>) -> Self;

    /// (x, v) one whole step later.
    fn step(&self, x: F, v: F) -> (F, F);

    /// (x, v) a part of a step later, `time_s` in [0, h].
    fn part(&self, x: F, v: F, time_s: F) -> (F, F);

    /// True if a step is the same linear map for all (x, v).
    const IS_LINEAR: bool = false;

    /// That map.
    #[inline]
    fn whole_step(&self) -> Option<&Transition<F>> {
        None
    }
}

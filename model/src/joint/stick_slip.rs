//! The interface of the stick-slip object.

use crate::joint::{Event, Phase, ShaftStep, StepCoefficients};
use crate::real::Real;

/// An imaginary object on its spring, dragged by the shaft.
///
/// A joint starts in stick with θ = 0. Its state can be read between steps;
/// a step moves it and reports its events in the order of time.
pub trait StickSlip<F: Real>: Send + 'static {
    /// Moves the object through one step. `on_event` is called at most
    /// [`EVENTS_PER_STEP`](crate::EVENTS_PER_STEP) times.
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: impl FnMut(Event<F>));

    /// Puts the object in stick where the shaft is, showing `torque_nm` (at
    /// most ±Ts) while the shaft moves with `omega_rad_s`: to resume after
    /// missing samples.
    fn restart(&mut self, torque_nm: F, omega_rad_s: F);

    /// Goes on in steps of another length, between two steps: `coefficients` are of the same
    /// settings. A simulator splits a step so where the shaft's motion breaks.
    fn change_step(&mut self, coefficients: StepCoefficients<F>);

    /// The numbers that its steps use.
    fn coefficients(&self) -> &StepCoefficients<F>;

    /// Current phase.
    fn phase(&self) -> Phase;

    /// The torque shown to the hand, N·m: T > 0 opposes growing angle,
    /// |T| ≤ Ts always.
    fn torque_nm(&self) -> F;

    /// Angle θ of the object, rad.
    fn theta_rad(&self) -> F;

    /// Velocity θ̇ of the object, rad/s.
    fn theta_dot_rad_s(&self) -> F;
}

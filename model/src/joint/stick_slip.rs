//! The interface of the stick-slip object.

use crate::joint::{Coast, Event, Phase, ShaftStep, SlipLane, StepCoefficients};
use crate::real::Real;

/// An imaginary object on its spring, dragged by the shaft.
///
/// A joint starts in stick with θ = 0. Its state can be read between steps;
/// a step moves it and reports its events in the order of time.
pub trait StickSlip<F: Real>: Send + 'static {
    /// True if its slips can be stepped as [lanes](SlipLane).
    const HAS_LANES: bool = false;

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

    /// (θ, θ̇), rad and rad/s: for those who want both, which share their work.
    #[inline]
    fn motion(&self) -> (F, F) {
        (self.theta_rad(), self.theta_dot_rad_s())
    }

    /// The next steps, if whatever the shaft does has no part in them.
    #[inline]
    fn coast(&self) -> Option<Coast<F>> {
        None
    }

    /// Moves through steps of its [`coast`](Self::coast), at most as many as that has, to a shaft that moves
    /// with `omega_rad_s`. A joint that never coasts stays where it is.
    #[inline]
    fn skip(&mut self, _steps: u32, _omega_rad_s: F) {}

    /// Its slip as a lane of several; `None` in stick, and for a joint without [lanes](Self::HAS_LANES).
    #[inline]
    fn slip_lane(&self) -> Option<SlipLane<F>> {
        None
    }

    /// Moves its slip to (x, v), where the steps of its lane have got, on a shaft that moves with `omega_rad_s`.
    #[inline]
    fn set_slip(&mut self, _x: F, _v: F, _omega_rad_s: F) {}
}

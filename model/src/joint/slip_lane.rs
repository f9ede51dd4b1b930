//! A slip under `paper` or `physical` as one lane of several: its step is the same operations for all of
//! them, as long as the velocities surely do not meet.

use crate::joint::Sense;
use crate::joint::oscillator::{Oscillator, Transition};
use crate::real::Real;

/// State of a slip and the numbers of its step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlipLane<F> {
    /// θ − s·Tk/kr, rad.
    pub x: F,
    /// Velocity of the object, rad/s.
    pub v: F,
    /// s, +1 or −1.
    pub sign: F,
    /// Change of (x, v) in a step by x and v.
    pub transition: [F; 4],
    /// ωn, rad/s, and the factor of the bound of |v̈|, rad²/s².
    pub bound: [F; 2],
    /// s·Tk/kr, rad.
    pub middle_rad: F,
}

impl<F: Real> SlipLane<F> {
    /// Lane of a slip at (x, v).
    pub(crate) fn new(
        sense: Sense,
        (x, v): (F, F),
        transition: &Transition<F>,
        oscillator: &Oscillator<F>,
        middle_rad: F,
    ) -> Self {
        Self {
            x,
            v,
            sign: sense.of_signed(F::ONE),
            transition: transition.factors(),
            bound: oscillator.bound_factors(),
            middle_rad: sense.of_signed(middle_rad),
        }
    }

    /// (x, v) after a step of the shaft from `omega` to `omega_end`, rad/s, and whether the velocities
    /// surely did not meet: else the joint itself has to look.
    ///
    /// A lead that bends by less than M dips below its chord by at most M·h²/8.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    #[expect(clippy::needless_bitwise_bool, reason = "no branch in a lane")]
    pub fn stepped(self, omega: F, omega_end: F, step_s: F, per_step: F) -> (F, F, bool) {
        let omega_dot = (omega_end - omega) * per_step;
        let Self { x, v, sign, .. } = self;
        let (end_x, end_v) = Transition::of(self.transition).apply(x, v);
        let [omega_n, jerk_factor] = self.bound;
        let bound = jerk_factor * (v.abs() + omega_n * x.abs());
        let dip = bound * step_s * step_s * F::from_f64(0.125);
        let start = sign * (omega - v);
        let end = sign * ((omega + omega_dot * step_s) - end_v);
        let is_sure = (start > dip) & (end > dip);
        (end_x.settled(), end_v.settled(), is_sure)
    }
}

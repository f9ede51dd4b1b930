//! The laws of a joint's events and state.

use crepitus_model::{Event, Phase, Real, StickSlip};

/// Sees the events of one tick go by.
pub(crate) struct Events<F> {
    phase: Phase,
    last: F,
    count: usize,
    largest_nm: F,
}

impl<F: Real> Events<F> {
    /// Observer of the events of a joint that is in `phase`.
    pub(crate) fn from(phase: Phase) -> Self {
        Self {
            phase,
            last: F::ZERO,
            count: 0,
            largest_nm: F::ZERO,
        }
    }

    /// Events are in the order of time, within the step, and each begins in
    /// the phase in which the one before has ended.
    pub(crate) fn see(&mut self, event: &Event<F>) {
        assert!(
            event.fraction >= self.last && event.fraction <= F::ONE,
            "order: {event:?} after {:?}",
            self.last
        );
        assert!(
            event.from == self.phase && event.to != event.from,
            "phases: {event:?} in {:?}",
            self.phase
        );
        (self.last, self.phase) = (event.fraction, event.to);
        self.count += 1;
        let before = event.torque_before_nm.abs();
        let after = event.torque_after_nm.abs();
        self.largest_nm = self.largest_nm.at_least(before).at_least(after);
    }

    /// There are no more than `most` of them, and they lead to the joint's
    /// phase.
    pub(crate) fn end<J: StickSlip<F>>(&self, joint: &J, most: usize) {
        assert!(self.count <= most, "{} events", self.count);
        assert_eq!(joint.phase(), self.phase, "phase without an event");
    }

    /// No event shows more than `limit_nm`.
    pub(crate) fn within(&self, limit_nm: F) {
        assert!(
            self.largest_nm <= limit_nm,
            "{:?} N·m in an event, Ts is {limit_nm:?}",
            self.largest_nm
        );
    }
}

/// The torque is within ±Ts, so it is a number.
pub(crate) fn torque<F: Real, J: StickSlip<F>>(joint: &J) {
    let (torque, limit) = (joint.torque_nm(), joint.coefficients().static_nm);
    assert!(torque.abs() <= limit, "{torque:?} N·m, Ts is {limit:?}");
}

/// The state is finite.
pub(crate) fn state<F: Real, J: StickSlip<F>>(joint: &J) {
    let (theta, theta_dot) = (joint.theta_rad(), joint.theta_dot_rad_s());
    assert!(
        theta.is_finite() && theta_dot.is_finite(),
        "θ = {theta:?}, θ̇ = {theta_dot:?}"
    );
}

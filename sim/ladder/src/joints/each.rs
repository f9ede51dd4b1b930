//! A joint with its shaft, and the work of some joints.

use crate::joints::motion::{Columns, Counts, State, StepEvent};
use crepitus_model::{Real, ShaftStep, StepCoefficients, StickSlip};

/// Steps between two looks whether to go on.
pub(crate) const UNWATCHED_STEPS: usize = 1 << 16;

/// A joint with what its steps need besides.
#[derive(Clone)]
pub(crate) struct Each<J, F> {
    pub(crate) joint: J,
    /// Shaft velocity at the end of the last step, rad/s.
    pub(crate) omega_rad_s: F,
    pub(crate) counts: Counts,
    /// Events since they were taken, if they are recorded.
    pub(crate) events: Option<Vec<StepEvent<F>>>,
}

/// A part of a step: its coefficients, and the shaft meanwhile.
pub type StepPart<F> = (StepCoefficients<F>, ShaftStep<F>);

/// Receiver of the events of a step and the state after it.
pub(crate) type AfterStep<'a, F> = dyn FnMut(&[StepEvent<F>], &State<F>) + 'a;

/// Motion and columns of some joints.
pub struct Work<'a, F> {
    /// Of all joints, or (`is_of_each`) one behind the other.
    pub(crate) turns_rad: &'a [F],
    pub(crate) speeds_rad_s: &'a [F],
    pub(crate) is_of_each: bool,
    /// Steps of each joint.
    pub(crate) steps: usize,
    pub(crate) columns: Columns<'a, F>,
}

impl<F> Work<'_, F> {
    /// The work of the first joints, and that of the others.
    pub(crate) fn split(self, joints: usize) -> (Self, Self) {
        let count = joints * self.steps;
        let (first, rest) = self.columns.split(count);
        let after = if self.is_of_each { count } else { 0 };
        let first = Self {
            columns: first,
            ..self
        };
        let rest = Self {
            turns_rad: &self.turns_rad[after..],
            speeds_rad_s: &self.speeds_rad_s[after..],
            columns: rest,
            ..self
        };
        (first, rest)
    }
}

impl<F: Real, J: StickSlip<F>> Each<J, F> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a loop around it holds its state")]
    pub(crate) fn step(&mut self, step: usize, turn_rad: F, speed_rad_s: F) {
        let shaft = ShaftStep {
            delta_phi_rad: turn_rad,
            omega_start_rad_s: self.omega_rad_s,
            omega_end_rad_s: speed_rad_s,
        };
        self.step_on(step, &shaft);
    }

    /// Step number `step` of its arrays.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a loop around it holds its state")]
    pub(crate) fn step_on(&mut self, step: usize, shaft: &ShaftStep<F>) {
        let (counts, events) = (&mut self.counts, &mut self.events);
        self.joint.step(shaft, |event| {
            counts.count(event.kind);
            if let Some(events) = events {
                events.push(StepEvent { step, event });
            }
        });
        self.omega_rad_s = shaft.omega_end_rad_s;
    }
}

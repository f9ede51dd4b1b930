//! Accounts of a joint that is stepped, step by step.

use super::lead::Lead;
use super::tally::{Gap, ObjectState, StickEnd, Stretch, Tally};
use crate::trace::EventRecord;
use crepitus_model::joint::StepCoefficients;
use crepitus_model::{
    EVENTS_PER_STEP, Event, Phase, Real, Settings, ShaftStep, StickSlip, Validated,
};

/// Keeps the tally of a stepping run: where in the step it is, and what the
/// joint has seen of the shaft.
#[derive(Clone)]
pub(super) struct StepAccounting {
    pub(super) tally: Tally,
    /// Length of the step, or of the part of one that is being accounted for, s.
    pub(super) step_s: f64,
    /// Angle of the shaft as the joint has seen it, at the start of the step.
    pub(super) phi_rad: f64,
    /// The last point of the step that is booked, as a fraction of it.
    booked: f64,
    stick: StickEnd,
    /// Events of the present step.
    in_step: usize,
    /// Steps with as many events as a step may have: more may have followed.
    pub(super) crowded_steps: u64,
    /// While the device refuses samples.
    gap: Option<Gap>,
    /// Gaps after which the joint began again.
    restarts: u32,
}

impl StepAccounting {
    /// Accounting of a joint in precision `F`.
    pub(super) fn new<F: Real>(
        settings: &Validated<Settings>,
        step_s: f64,
        omega_rad_s: f64,
    ) -> Self {
        let lead = Lead::new(settings, step_s, F::IS_SINGLE);
        let touches = StepCoefficients::<F>::new(settings, step_s).is_ok_and(|c| c.touches());
        Self {
            tally: Tally::new(**settings, omega_rad_s, lead, touches),
            step_s,
            phi_rad: 0.0,
            booked: 0.0,
            stick: StickEnd {
                theta_rad: 0.0,
                omega_rad_s,
                omega_dot: 0.0,
            },
            in_step: 0,
            crowded_steps: 0,
            gap: None,
            restarts: 0,
        }
    }

    /// Accounts for the events of a step in the order of time.
    pub(super) fn event<F: Real>(
        &mut self,
        start_s: f64,
        seen: &ShaftStep<F>,
        event: &Event<F>,
    ) -> EventRecord {
        let event = event.to_f64();
        let time_s = start_s + event.fraction * self.step_s;
        if event.from == Phase::Stick {
            self.book_stick(seen, event.fraction, event.theta_rad);
        }
        let travel = travel(seen, event.fraction, self.step_s);
        self.tally.event(time_s, self.phi_rad + travel, &event);
        self.in_step += 1;
        self.booked = event.fraction;
        self.stick = self.stick_end(seen, event.fraction, event.theta_rad);
        EventRecord::new(time_s, &event)
    }

    /// Accounts for the rest of a step.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    pub(super) fn end_step<F: Real, J: StickSlip<F>>(&mut self, seen: &ShaftStep<F>, joint: &J) {
        self.end_in(
            seen,
            joint.phase(),
            || (joint.torque_nm(), joint.theta_rad()),
            || joint.theta_dot_rad_s(),
        );
    }

    /// Accounts for the rest of a step that ends in this phase: in stick with a torque and θ, in slip with θ̇.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "as of its caller")]
    pub(super) fn end_in<F: Real>(
        &mut self,
        seen: &ShaftStep<F>,
        phase: Phase,
        stick: impl FnOnce() -> (F, F),
        theta_dot_rad_s: impl FnOnce() -> F,
    ) {
        match phase {
            Phase::Stick => self.end_stick(seen, stick()),
            Phase::Slip(sense) => {
                if self.tally.lead.is_due() {
                    let (omega, v) = (seen.omega_end_rad_s, theta_dot_rad_s());
                    let sign = sense.of_signed(1.0);
                    self.tally.lead.look(sign, omega.to_f64(), v.to_f64());
                }
            }
        }
        self.close(seen);
    }

    /// Accounts for the rest of a part of a step that is not its last: looks at a slip are a
    /// number of steps apart.
    #[cold]
    pub(super) fn end_part<F: Real>(
        &mut self,
        seen: &ShaftStep<F>,
        phase: Phase,
        stick: impl FnOnce() -> (F, F),
    ) {
        if phase == Phase::Stick {
            self.end_stick(seen, stick());
        }
        self.close(seen);
    }

    #[inline]
    fn end_stick<F: Real>(&mut self, seen: &ShaftStep<F>, (torque_nm, theta_rad): (F, F)) {
        self.tally.shown(torque_nm.to_f64());
        self.book_stick(seen, 1.0, theta_rad.to_f64());
    }

    #[inline]
    fn close<F: Real>(&mut self, seen: &ShaftStep<F>) {
        if self.in_step > 0 {
            self.crowded_steps += u64::from(self.in_step >= EVENTS_PER_STEP);
            self.in_step = 0;
            self.booked = 0.0;
        }
        self.phi_rad += seen.delta_phi_rad.to_f64();
    }

    /// Accounts for a step whose sample the device refused: its joint never learns of this travel
    /// and stands still; what it showed last is held or released.
    #[cold]
    pub(super) fn hold<F: Real, J: StickSlip<F>>(
        &mut self,
        seen: &ShaftStep<F>,
        start_s: f64,
        joint: &J,
        held_nm: f64,
    ) {
        let delta_phi = seen.delta_phi_rad.to_f64();
        let (step_s, phi_rad) = (self.step_s, self.phi_rad);
        let begin = || Gap::new(object_state(start_s, phi_rad, joint));
        let gap = self.gap.get_or_insert_with(begin);
        gap.hold(held_nm, step_s, delta_phi);
        self.tally.shown(held_nm);
    }

    /// Accounts for a step whose sample a device took; `restarts` counts the gaps so far after
    /// which its joint began again.
    #[inline]
    pub(super) fn end_tick<F: Real, J: StickSlip<F>>(
        &mut self,
        seen: &ShaftStep<F>,
        start_s: f64,
        joint: &J,
        restarts: u32,
    ) {
        if restarts == self.restarts {
            self.end_step(seen, joint);
            if self.gap.is_some() {
                self.close_gap();
            }
            return;
        }
        self.restart(seen, start_s, joint, restarts);
    }

    /// Ends a gap after which the joint went on.
    #[cold]
    fn close_gap(&mut self) {
        if let Some(gap) = self.gap.take() {
            self.tally.caught_up(&gap);
        }
    }

    /// Accounts for a step in which the joint began again.
    #[cold]
    fn restart<F: Real, J: StickSlip<F>>(
        &mut self,
        seen: &ShaftStep<F>,
        start_s: f64,
        joint: &J,
        restarts: u32,
    ) {
        let gap = self.gap.take();
        self.restarts = restarts;
        self.phi_rad += seen.delta_phi_rad.to_f64();
        let now = object_state(start_s + self.step_s, self.phi_rad, joint);
        self.stick = self.stick_end(seen, 1.0, now.theta_rad);
        self.tally.constant(joint.torque_nm().to_f64(), self.step_s);
        if let Some(gap) = gap {
            self.tally.restart(&gap, now);
        }
    }

    /// Completes the totals at the end of the run.
    pub(super) fn finish<F: Real, J: StickSlip<F>>(&mut self, time_s: f64, joint: &J) {
        self.finish_in(object_state(time_s, self.phi_rad, joint));
    }

    /// Completes the totals at the end of the run, with the object in this state.
    pub(super) fn finish_in(&mut self, end: ObjectState) {
        if let Some(gap) = self.gap.take() {
            self.tally.restart(&gap, end);
        }
        self.tally
            .finish(end.time_s, end.phi_rad, end.theta_rad, end.theta_dot_rad_s);
    }

    /// Accounts for the stick from the last booked point to `fraction`.
    #[inline]
    fn book_stick<F: Real>(&mut self, seen: &ShaftStep<F>, fraction: f64, theta_rad: f64) {
        // A step begins after a jump of the velocity.
        let omega_rad_s = if self.booked > 0.0 {
            self.stick.omega_rad_s
        } else {
            seen.omega_start_rad_s.to_f64()
        };
        let part = (self.booked, fraction);
        self.stick_through(&stretch(seen, part, omega_rad_s, self.step_s), theta_rad);
    }

    /// Accounts for a stretch of stick that ends with the object at `theta_rad`.
    #[inline]
    fn stick_through(&mut self, stretch: &Stretch, theta_rad: f64) {
        self.tally
            .stick_over(stretch, self.stick.theta_rad, theta_rad);
        self.stick = stretch.end(theta_rad);
    }

    /// Accounts for a whole step in stick, without an event; `phi_rad` is where it ends.
    #[inline]
    pub(super) fn whole_stick(&mut self, stretch: &Stretch, torque_nm: f64, theta_rad: f64) {
        self.tally.shown(torque_nm);
        self.stick_through(stretch, theta_rad);
    }

    /// The stick at `fraction` of the step.
    #[inline]
    fn stick_end<F: Real>(&self, seen: &ShaftStep<F>, fraction: f64, theta_rad: f64) -> StickEnd {
        let (omega_rad_s, omega_dot) = velocity(seen, fraction, self.step_s);
        StickEnd {
            theta_rad,
            omega_rad_s,
            omega_dot,
        }
    }
}

/// The shaft's velocity, rad/s, and acceleration, rad/s², at `fraction` of a step.
#[inline]
fn velocity<F: Real>(seen: &ShaftStep<F>, fraction: f64, step_s: f64) -> (f64, f64) {
    let (a, b) = (
        seen.omega_start_rad_s.to_f64(),
        seen.omega_end_rad_s.to_f64(),
    );
    (a + fraction * (b - a), (b - a) / step_s)
}

/// The part of a step between two fractions of it, which the shaft begins with `omega_rad_s`.
#[inline]
fn stretch<F: Real>(
    seen: &ShaftStep<F>,
    (from, to): (f64, f64),
    omega_rad_s: f64,
    step_s: f64,
) -> Stretch {
    let end = velocity(seen, to, step_s);
    let delta_phi = travel(seen, to, step_s) - travel(seen, from, step_s);
    Stretch::new((to - from) * step_s, delta_phi, (omega_rad_s, end.1), end)
}

/// A whole step.
#[inline]
pub(super) fn whole_stretch<F: Real>(seen: &ShaftStep<F>, step_s: f64) -> Stretch {
    stretch(seen, (0.0, 1.0), seen.omega_start_rad_s.to_f64(), step_s)
}

fn object_state<F: Real, J: StickSlip<F>>(time_s: f64, phi_rad: f64, joint: &J) -> ObjectState {
    ObjectState {
        phase: joint.phase(),
        time_s,
        phi_rad,
        theta_rad: joint.theta_rad().to_f64(),
        theta_dot_rad_s: joint.theta_dot_rad_s().to_f64(),
    }
}

/// Shaft angle travelled after `fraction` of a step, rad.
#[inline]
fn travel<F: Real>(seen: &ShaftStep<F>, fraction: f64, step_s: f64) -> f64 {
    ShaftStep {
        delta_phi_rad: seen.delta_phi_rad.to_f64(),
        omega_start_rad_s: seen.omega_start_rad_s.to_f64(),
        omega_end_rad_s: seen.omega_end_rad_s.to_f64(),
    }
    .travel(fraction, step_s)
}

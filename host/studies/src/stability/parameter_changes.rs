//! A frozen joint whose parameters change during a run: each commit is one
//! ramp, and every adjustment is observed.

use super::observation::Observation;
use super::subject::Subject;
use crate::sampling::Sampling;
use crate::true_events::TimedEvent;
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::Locate;
use crepitus_model::solver::{LocatorVisitor, with_frozen_locator};
use crepitus_model::{
    EventKind, Frozen, Parameters, Phase, Real, Settings, SettingsError, ShaftStep,
    StepCoefficients, StickSlip, Validated,
};

/// The device's slew limit, N·m/s.
pub(super) const SLEW_NM_PER_S: f64 = 100.0;

/// A joint and its changes of parameters.
pub(super) struct ParameterChanges<'a> {
    pub(super) settings: Validated<Settings>,
    pub(super) sampling: Sampling<'a>,
    /// New parameters, and their times, s.
    pub(super) changes: &'a [(f64, Parameters)],
}

impl ParameterChanges<'_> {
    pub(super) fn observe<F: Real>(self, subject: Subject) -> Result<Observation, SettingsError> {
        with_frozen_locator::<F, _>(subject.solver.of_a_device(), self)
    }
}

/// The energy stored in a frozen object, J: that of its spring, and in a slip,
/// where it moves freely, its kinetic energy.
fn stored_j<F: Real, L: Locate<F, Shape = Linear>>(joint: &Frozen<F, L>) -> f64 {
    let (a, theta) = (joint.coefficients(), joint.theta_rad().to_f64());
    let spring = 0.5 * a.stiffness.to_f64() * theta * theta;
    match joint.phase() {
        Phase::Stick => spring,
        Phase::Slip(_) => {
            spring + 0.5 * a.inertia.to_f64() * joint.theta_dot_rad_s().to_f64().powi(2)
        }
    }
}

impl<F: Real> LocatorVisitor<F> for ParameterChanges<'_> {
    type Output = Result<Observation, SettingsError>;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output {
        let step_s = self.sampling.step_s();
        let coefficients = StepCoefficients::<F>::new(&self.settings, step_s)?;
        let mut joint = Frozen::<F, L>::new(coefficients, F::ZERO);
        let mut ramp = Ramp::at(coefficients);
        let mut seen = Observation::of_steps(step_s);
        let mut slip_j = None;
        let mut changes = self.changes.iter().peekable();
        let mut walk = self.sampling.walk_from(0);
        let mut chunk = Vec::new();
        loop {
            walk.fill(&mut chunk, 1);
            let Some(shaft) = chunk.first() else {
                return Ok(seen);
            };
            let now_s = self.sampling.time_s(seen.steps, 0.0);
            while let Some(&(_, parameters)) = changes.next_if(|(at_s, _)| *at_s <= now_s) {
                let next = Settings {
                    parameters,
                    ..*self.settings
                };
                let next = StepCoefficients::new(&next.validate()?, step_s)?;
                ramp = Ramp::new(*joint.coefficients(), next, SLEW_NM_PER_S);
            }
            tick(&mut joint, &mut ramp, shaft, now_s, &mut slip_j, &mut seen);
        }
    }
}

/// One tick: the adjustment that is due, and the step.
fn tick<F: Real, L: Locate<F, Shape = Linear>>(
    joint: &mut Frozen<F, L>,
    ramp: &mut Ramp<F>,
    shaft: &ShaftStep<F>,
    now_s: f64,
    slip_j: &mut Option<f64>,
    seen: &mut Observation,
) {
    let before_nm = joint.torque_nm().to_f64();
    if let Some(next) = ramp.advance() {
        let before_j = stored_j(joint);
        joint.adjust(next);
        let rise = (stored_j(joint) - before_j) / before_j.max(f64::MIN_POSITIVE);
        seen.energy_rise = seen.energy_rise.max(rise);
    }
    let step_s = seen.step_s;
    let mut events = 0;
    let stiffness = joint.coefficients().stiffness.to_f64();
    joint.step(shaft, |event| {
        events += 1;
        let spring_j = 0.5 * stiffness * event.theta_rad.to_f64().powi(2);
        match event.kind {
            EventKind::Break => *slip_j = Some(spring_j),
            EventKind::Stick | EventKind::Reverse => {
                if let Some(held_j) = slip_j.take() {
                    let excess = (spring_j - held_j) / held_j.max(f64::MIN_POSITIVE);
                    seen.slip_energy = seen.slip_energy.max(excess);
                }
            }
        }
        seen.tally.add(&TimedEvent::new(
            now_s + event.fraction.to_f64() * step_s,
            &event,
        ));
    });
    let a = joint.coefficients();
    let torque_nm = joint.torque_nm().to_f64();
    seen.row::<F>(now_s, torque_nm, a.static_nm.to_f64(), 0);
    if events == 0 {
        // The shaft's travel in a stick is not limited by the slew rate.
        let wound_nm = match joint.phase() {
            Phase::Stick => (a.stiffness * shaft.delta_phi_rad).abs().to_f64(),
            Phase::Slip(_) => 0.0,
        };
        let moved_nm = (torque_nm - before_nm).abs() - wound_nm;
        seen.slew = seen.slew.max(moved_nm / (SLEW_NM_PER_S * step_s));
    }
}

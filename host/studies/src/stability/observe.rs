//! Runs a subject on an input and observes it.

use super::criterion::BOUND_SLACK;
use super::energy_audit::EnergyAudit;
use super::guarded_joint::GuardedJoint;
use super::input::{Attempt, Input};
use super::observation::{MOST_KEPT, Observation};
use super::parameter_changes::ParameterChanges;
use super::rendered::RenderedRun;
use super::shaking_hand::ShakingHand;
use super::source::{Source, first_omega_rad_s, motion, source};
use super::subject::{Rung, Subject};
use super::without_steps::without_steps;
use crate::sampling::{CHUNK_STEPS, Sampling};
use crate::true_events::TimedEvent;
use crate::watcher::{Cancelled, StudyError};
use crepitus_model::solver::Solver;
use crepitus_model::{
    Convention, EVENTS_PER_STEP, Event, EventKind, Parameters, Phase, Real, Settings, ShaftStep,
    StickSlip,
};
use crepitus_scene::any_joint::{AnyJoint, Precise};
use crepitus_scene::scene::Precision;

/// Number of steps between two polls.
const STEPS_PER_POLL: u64 = 65_536;

/// The most events that a step reports.
#[expect(clippy::cast_possible_truncation, reason = "eight")]
const MOST_EVENTS: u32 = EVENTS_PER_STEP as u32;

/// Largest ωn·h at which the audit is accurate with damping.
const AUDITED_RADIANS: f64 = 0.05;

/// Runs `subject` with `settings` on `input`; the late torque is that
/// after `late_s`. `poll` gets the number of steps since its last call, and
/// may cancel the run.
pub(super) fn observe(
    subject: Subject,
    settings: &Settings,
    input: &Input,
    late_s: f64,
    poll: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Observation, StudyError> {
    if let Input::Refusals(attempts) = input {
        return Ok(attempt(subject, attempts));
    }
    if let Input::SymptomRefusals(attempts) = input {
        return Ok(super::symptom::attempt(attempts));
    }
    if let Input::Scene(run) = input {
        return Ok(super::scene_run::observe(subject, run, late_s));
    }
    if let Input::Actuator(run) = input {
        return Ok(super::actuator::observe(subject, run, late_s));
    }
    if let Input::ActuatorLoop(linear) = input {
        return Ok(super::actuator::observe_loop(linear));
    }
    if let Input::Symptoms(run) = input {
        return super::symptom::observe(subject, run, late_s);
    }
    let Rung::Ladder(solver) = subject.solver else {
        return Ok(without_steps(settings, input, late_s)?);
    };
    match subject.precision {
        Precision::F32 => run::<f32>(subject, solver, settings, input, late_s, poll),
        Precision::F64 => run::<f64>(subject, solver, settings, input, late_s, poll),
    }
}

fn run<F: Precise>(
    subject: Subject,
    solver: Solver,
    settings: &Settings,
    input: &Input,
    late_s: f64,
    poll: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Observation, StudyError> {
    let settings = settings.validate()?;
    let (duration_s, step_s) = input.duration_and_step_s().unwrap_or((0.0, 1.0));
    let motion = motion(input);
    let sampling = Sampling::new(&motion, duration_s, step_s);
    match input {
        Input::ParameterChanges { changes, .. } => {
            let run = ParameterChanges {
                settings,
                sampling,
                changes,
            };
            return Ok(run.observe::<F>(subject)?);
        }
        Input::ShakingHand { shake, .. } => {
            let run = ShakingHand {
                settings,
                sampling,
                shake: *shake,
            };
            return Ok(run.observe::<F>(subject)?);
        }
        Input::Rendered(rendered) => {
            let run = RenderedRun {
                settings,
                sampling,
                rendered,
                late_s,
            };
            return Ok(run.observe::<F>(subject)?);
        }
        _ => {}
    }
    let omega_rad_s = first_omega_rad_s(input, &motion);
    let p = settings.parameters;
    // The motion of the shaft during missing samples is unknown.
    let audited = subject.convention == Convention::Physical
        && !input.needs_guard()
        && (p.damping_nms_per_rad == 0.0 || p.natural_rad_s() * step_s <= AUDITED_RADIANS);
    let observer = StepObserver {
        source: source::<F>(input, &sampling, &motion)?,
        sampling,
        parameters: p,
        frozen: subject.convention == Convention::Frozen,
        audit: audited.then(|| EnergyAudit::new(p, step_s, F::from_f64(omega_rad_s).to_f64())),
        late_step: (late_s / step_s).ceil(),
        guard_from_rad_s: input.needs_guard().then(|| F::from_f64(omega_rad_s)),
        poll,
    };
    let omega = F::from_f64(omega_rad_s);
    let joint = AnyJoint::new(&settings, solver, step_s, omega)?;
    Ok(observer.run_behind_check_if_needed(joint)?)
}

/// Tries to build each joint.
fn attempt(subject: Subject, attempts: &[Attempt]) -> Observation {
    let accepts = |attempt: &&Attempt| {
        attempt.settings.validate().is_ok_and(|settings| {
            let Rung::Ladder(solver) = subject.solver else {
                return true;
            };
            let step_s = attempt.step_s;
            match subject.precision {
                Precision::F32 => AnyJoint::<f32>::new(&settings, solver, step_s, 1.0).is_ok(),
                Precision::F64 => AnyJoint::<f64>::new(&settings, solver, step_s, 1.0).is_ok(),
            }
        })
    };
    Observation {
        accepted: attempts.iter().filter(accepts).map(|a| a.what).collect(),
        ..Observation::default()
    }
}

/// Observes a joint after every step.
struct StepObserver<'a, F> {
    source: Box<dyn Source<F> + 'a>,
    sampling: Sampling<'a>,
    parameters: Parameters,
    frozen: bool,
    audit: Option<EnergyAudit>,
    /// First step of the late torque.
    late_step: f64,
    /// Velocity at the start, rad/s, if the input needs the check.
    guard_from_rad_s: Option<F>,
    poll: &'a mut dyn FnMut(f64) -> Result<(), Cancelled>,
}

impl<F: Real> StepObserver<'_, F> {
    fn run_behind_check_if_needed(self, joint: AnyJoint<F>) -> Result<Observation, Cancelled> {
        match self.guard_from_rad_s {
            Some(omega_rad_s) => {
                let step_s = self.sampling.step_s();
                self.run(GuardedJoint::new(joint, step_s, omega_rad_s))
            }
            None => self.run(joint),
        }
    }

    fn run<J: StickSlip<F>>(mut self, mut joint: J) -> Result<Observation, Cancelled> {
        let first_torque_nm = joint.torque_nm().to_f64();
        let mut seen = Observation {
            step_s: self.sampling.step_s(),
            first_torque_nm,
            last_torque_nm: first_torque_nm,
            ..Observation::default()
        };
        let late_step = self.late_step.whole();
        let mut chunk = Vec::with_capacity(CHUNK_STEPS);
        let mut unseen = 0_u64;
        loop {
            self.source.fill(&mut chunk, joint.torque_nm());
            if chunk.is_empty() {
                break;
            }
            for shaft in &chunk {
                self.step(&mut joint, shaft, &mut seen);
                if seen.steps > late_step {
                    seen.late_torque.add(seen.last_torque_nm);
                }
                if seen.overflow_s.is_some() {
                    return Ok(seen);
                }
            }
            // In a frozen slip these take trigonometry: sampling them now and
            // then is enough, as nothing is computed from them.
            let finite = joint.theta_rad().is_finite() && joint.theta_dot_rad_s().is_finite();
            if !finite {
                seen.overflow_s = Some(self.sampling.time_s(seen.steps, 0.0));
                return Ok(seen);
            }
            unseen += u64::try_from(chunk.len()).unwrap_or(0);
            if unseen >= STEPS_PER_POLL {
                (self.poll)(f64::from_whole(unseen))?;
                unseen = 0;
            }
        }
        // After the cap the times of events are unknown.
        let is_capped = seen.tally.most_in_step >= MOST_EVENTS;
        let known = self.audit.as_ref().filter(|_| !is_capped);
        seen.imbalance = known.map(EnergyAudit::worst);
        if let Some(audit) = &self.audit {
            seen.work_j = audit.work_j();
        }
        seen.swing_rad = self.source.swing_rad();
        (self.poll)(f64::from_whole(unseen))?;
        Ok(seen)
    }

    #[inline]
    fn step<J: StickSlip<F>>(
        &mut self,
        joint: &mut J,
        shaft: &ShaftStep<F>,
        seen: &mut Observation,
    ) {
        let Parameters {
            static_torque_nm,
            kinetic_torque_nm,
            stiffness_nm_per_rad,
            ..
        } = self.parameters;
        let limit_nm = static_torque_nm * (1.0 + BOUND_SLACK);
        let mut in_step = 0;
        joint.step(shaft, |event| {
            in_step += 1;
            if let Some(audit) = &mut self.audit {
                audit.event(shaft, &event);
            }
            note(seen, &self.sampling, shaft, &event, limit_nm);
        });
        seen.tally.most_in_step = seen.tally.most_in_step.max(in_step);
        seen.steps += 1;
        let before_nm = seen.last_torque_nm;
        let torque = joint.torque_nm();
        let torque_nm = torque.to_f64();
        // A missing sample has no travel.
        let travel_rad = Some(shaft.delta_phi_rad.to_f64())
            .filter(|travel| travel.is_finite())
            .unwrap_or(0.0);
        seen.add_torque::<F>(torque_nm);
        if torque_nm.to_bits() != before_nm.to_bits() {
            seen.last_change = seen.steps;
        }
        if stiffness_nm_per_rad * travel_rad.abs() > 2.0 * (static_torque_nm - kinetic_torque_nm) {
            seen.unresolved_steps += 1;
        }
        let mut finite = torque_nm.is_finite();
        let mut above = torque_nm.abs() > limit_nm;
        let stick = joint.phase() == Phase::Stick;
        if !self.frozen || stick {
            let (theta, v) = (joint.theta_rad().to_f64(), joint.theta_dot_rad_s().to_f64());
            finite &= theta.is_finite() && v.is_finite();
            // At the cap a pending break waits for the next step.
            let is_capped = in_step >= MOST_EVENTS;
            above |= self.frozen && !is_capped && stiffness_nm_per_rad * theta.abs() > limit_nm;
            if v != 0.0 && v.abs() < smallest_normal::<F>() {
                seen.subnormals += 1;
            }
            if let Phase::Slip(sense) = joint.phase() {
                let lag = sense.of_signed(v - shaft.omega_end_rad_s.to_f64());
                seen.lag_rad_s = seen.lag_rad_s.max(lag);
            }
            if let Some(audit) = &mut self.audit {
                audit.end_of_step(shaft, theta, v);
            }
        }
        if self.audit.is_none() {
            seen.work_j += 0.5 * (before_nm + torque_nm) * travel_rad;
        }
        if !finite && seen.overflow_s.is_none() {
            seen.overflow_s = Some(self.sampling.time_s(seen.steps, 0.0));
        }
        if above && seen.above_s.is_none() {
            seen.above_s = Some(self.sampling.time_s(seen.steps, 0.0));
        }
        if static_torque_nm > 0.0 {
            seen.peak = seen.peak.max(torque_nm.abs() / static_torque_nm);
        }
    }
}

/// Records an event of the step after those already counted.
fn note<F: Real>(
    seen: &mut Observation,
    sampling: &Sampling<'_>,
    shaft: &ShaftStep<F>,
    event: &Event<F>,
    limit_nm: f64,
) {
    let time_s = sampling.time_s(seen.steps, event.fraction.to_f64());
    let timed = TimedEvent::new(time_s, event);
    let after_nm = event.torque_after_nm.to_f64();
    let torques = [event.torque_before_nm.to_f64(), after_nm];
    let finite = event.theta_rad.is_finite()
        && event.theta_dot_rad_s.is_finite()
        && time_s.is_finite()
        && torques.iter().all(|t| t.is_finite());
    if !finite && seen.overflow_s.is_none() {
        seen.overflow_s = Some(sampling.time_s(seen.steps, 0.0));
    }
    if torques.iter().any(|t| t.abs() > limit_nm) && seen.above_s.is_none() {
        seen.above_s = Some(time_s);
    }
    let at_rest = shaft.omega_start_rad_s == F::ZERO
        && shaft.omega_end_rad_s == F::ZERO
        && shaft.delta_phi_rad == F::ZERO;
    if at_rest && event.kind == EventKind::Break {
        seen.tally.breaks_at_rest += 1;
    }
    seen.tally.add(&timed);
    if seen.events.len() < MOST_KEPT {
        seen.events.push(timed);
        seen.torques_after_nm.push(after_nm);
    }
}

/// The smallest number with all its digits.
fn smallest_normal<F: Real>() -> f64 {
    if F::NAME == <f32 as Real>::NAME {
        f64::from(f32::MIN_POSITIVE)
    } else {
        f64::MIN_POSITIVE
    }
}

//! Runs a subject on an input and observes it.

use super::criterion::BOUND_SLACK;
use super::device_run::DeviceRun;
use super::energy_audit::EnergyAudit;
use super::guarded_joint::GuardedJoint;
use super::input::{Input, What};
use super::observation::Observation;
use super::parameter_changes::ParameterChanges;
use super::source::{Source, source};
use super::subject::{Rung, Subject};
use super::without_steps::without_steps;
use super::{actuator, scene_run, symptom};
use crate::sampling::{CHUNK_STEPS, Sampling};
use crate::symptoms::Given;
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
    let late_step = (late_s / input.step_s).ceil().whole();
    Ok(match &input.what {
        What::Refusals(attempts) => {
            let mut seen = Observation::default();
            for &(what, parameters, step_s) in attempts {
                if accepts(subject, parameters, step_s) {
                    seen.accepted.push(what);
                }
            }
            seen
        }
        What::SymptomRefusals(attempts) => {
            let mut seen = Observation::default();
            for (what, symptoms) in attempts {
                if Given::settings_of(symptoms).check(None).is_ok() {
                    seen.accepted.push(what);
                }
            }
            seen
        }
        What::Scene(run) => scene_run::observe(subject, (input, run), late_s),
        What::Actuator(run) => actuator::observe(subject, (input, run), late_s),
        What::ActuatorLoop(linear) => actuator::observe_loop(linear),
        What::Symptoms(run) => symptom::observe(subject, (input, run), late_step)?,
        _ => match (subject.solver, subject.precision) {
            (Rung::Reference, _) => without_steps(settings, input, late_step)?,
            (Rung::Ladder(solver), Precision::F32) => {
                run::<f32>(subject, solver, settings, input, late_step, poll)?
            }
            (Rung::Ladder(solver), Precision::F64) => {
                run::<f64>(subject, solver, settings, input, late_step, poll)?
            }
        },
    })
}

/// Returns whether a joint can be built.
fn accepts(subject: Subject, parameters: Parameters, step_s: f64) -> bool {
    let settings = Settings {
        parameters,
        convention: subject.convention,
        ..Settings::default()
    };
    let (Ok(settings), Rung::Ladder(solver)) = (settings.validate(), subject.solver) else {
        return false;
    };
    match subject.precision {
        Precision::F32 => AnyJoint::<f32>::new(&settings, solver, step_s, 1.0).is_ok(),
        Precision::F64 => AnyJoint::<f64>::new(&settings, solver, step_s, 1.0).is_ok(),
    }
}

fn run<F: Precise>(
    subject: Subject,
    solver: Solver,
    settings: &Settings,
    input: &Input,
    late_step: u64,
    poll: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Observation, StudyError> {
    let settings = settings.validate()?;
    let motion = input.motion();
    let sampling = input.sampling(&motion);
    match &input.what {
        What::ParameterChanges(_, changes) => {
            let run = ParameterChanges {
                settings,
                sampling,
                changes,
            };
            return Ok(run.observe::<F>(subject)?);
        }
        What::ShakingHand(_, shake) => {
            let run = DeviceRun {
                settings,
                sampling,
                counts: shake.counts,
                lost: shake.lost,
                commits: (0, &[]),
            };
            return Ok(run.observe_hand::<F>(subject, shake.delay_ticks)?);
        }
        What::Rendered(_, rendered) => {
            let run = DeviceRun {
                settings,
                sampling,
                counts: rendered.counts,
                lost: rendered.lost,
                commits: (rendered.commit_every, &rendered.commits),
            };
            return Ok(run.observe::<F>(subject, late_step)?);
        }
        _ => {}
    }
    let (p, step_s, is_guarded) = (settings.parameters, input.step_s, input.needs_guard());
    let omega = F::from_f64(input.first_omega_rad_s());
    // The motion of the shaft during missing samples is unknown.
    let audited = subject.convention == Convention::Physical
        && !is_guarded
        && (p.damping_nms_per_rad == 0.0 || p.natural_rad_s() * step_s <= AUDITED_RADIANS);
    let observer = StepObserver {
        source: source::<F>(input, &motion)?,
        sampling,
        parameters: p,
        frozen: subject.convention == Convention::Frozen,
        audit: audited.then(|| EnergyAudit::new(p, step_s, omega.to_f64())),
        late_step,
        poll,
    };
    let joint = AnyJoint::new(&settings, solver, step_s, omega)?;
    Ok(if is_guarded {
        observer.run(GuardedJoint::new(joint, step_s, omega))?
    } else {
        observer.run(joint)?
    })
}

/// Observes a joint after every step.
struct StepObserver<'a, F> {
    source: Box<dyn Source<F> + 'a>,
    sampling: Sampling<'a>,
    parameters: Parameters,
    frozen: bool,
    audit: Option<EnergyAudit>,
    /// First step of the late torque.
    late_step: u64,
    poll: &'a mut dyn FnMut(f64) -> Result<(), Cancelled>,
}

impl<F: Real> StepObserver<'_, F> {
    fn run<J: StickSlip<F>>(mut self, mut joint: J) -> Result<Observation, Cancelled> {
        let first_torque_nm = joint.torque_nm().to_f64();
        let mut seen = Observation {
            first_torque_nm,
            last_torque_nm: first_torque_nm,
            ..Observation::of_steps(self.sampling.step_s())
        };
        let mut chunk = Vec::with_capacity(CHUNK_STEPS);
        let mut unseen = 0_u64;
        loop {
            self.source.fill(&mut chunk, joint.torque_nm());
            if chunk.is_empty() {
                break;
            }
            for shaft in &chunk {
                self.step(&mut joint, shaft, &mut seen);
                if seen.steps > self.late_step {
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
        if !finite || above {
            let now_s = self.sampling.time_s(seen.steps, 0.0);
            if !finite {
                seen.overflow_s.get_or_insert(now_s);
            }
            if above {
                seen.above_s.get_or_insert(now_s);
            }
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
    if !finite {
        let now_s = sampling.time_s(seen.steps, 0.0);
        seen.overflow_s.get_or_insert(now_s);
    }
    if torques.iter().any(|t| t.abs() > limit_nm) {
        seen.above_s.get_or_insert(time_s);
    }
    let at_rest = shaft.omega_start_rad_s == F::ZERO
        && shaft.omega_end_rad_s == F::ZERO
        && shaft.delta_phi_rad == F::ZERO;
    if at_rest && event.kind == EventKind::Break {
        seen.tally.breaks_at_rest += 1;
    }
    seen.event(timed, after_nm);
}

/// The smallest number with all its digits.
fn smallest_normal<F: Real>() -> f64 {
    if F::NAME == <f32 as Real>::NAME {
        f64::from(f32::MIN_POSITIVE)
    } else {
        f64::MIN_POSITIVE
    }
}

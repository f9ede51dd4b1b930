//! One rung at one step over a whole scene: its events and its torque against
//! the reference's.

use crate::accuracy::held_torque::HeldTorque;
use crate::accuracy::input::Feed;
use crate::accuracy::reference_torque::ReferenceTorque;
use crate::accuracy::scenes::StudyScene;
use crate::event_errors::EventErrors;
use crate::matching::match_events;
use crate::sampling::{CHUNK_STEPS, Sampling};
use crate::true_events::TimedEvent;
use crepitus_model::solver::Solver;
use crepitus_model::{Phase, Real, SettingsError, StickSlip};
use crepitus_scene::any_joint::{AnyJoint, Precise};
use crepitus_scene::run::Lead;
use crepitus_scene::scene::Precision;

/// The reference's run for the rungs of one scene at one step.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceRun<'a> {
    /// The scene.
    pub scene: &'a StudyScene,
    /// Motion of the scene, cut into steps.
    pub sampling: &'a Sampling<'a>,
    /// The reference's events up to the end of the last step.
    pub events: &'a [TimedEvent],
    /// The reference's torque at the ends of steps.
    pub torque: &'a ReferenceTorque,
    /// The reference's torque within steps.
    pub held: &'a HeldTorque,
}

/// Accuracy of a rung.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Events found.
    pub events: u64,
    /// Interior events of either side without a partner.
    pub unmatched: u64,
    /// Errors of the matched events.
    pub event_errors: EventErrors,
    /// Root mean square error of the held torque over continuous time, N·m.
    pub rms_held_torque_error_nm: f64,
    /// Largest error of the held torque at any time, N·m.
    pub max_held_torque_error_nm: f64,
    /// Root mean square torque error at the ends of steps, N·m.
    pub rms_tick_torque_error_nm: f64,
    /// Largest torque error at the end of a step, N·m.
    pub max_tick_torque_error_nm: f64,
    /// Time in slips in which the shaft was behind the object, s; NaN if
    /// the result is not finite.
    pub behind_s: f64,
    /// Energy that friction supplied in that time, J.
    pub behind_j: f64,
}

/// Runs a rung over the whole scene. A result that is not finite has all its
/// events unmatched and no errors (NaN).
///
/// # Errors
/// If the rung, the settings and the step cannot work together.
pub fn measure(
    target: &ReferenceRun<'_>,
    solver: Solver,
    precision: Precision,
) -> Result<Accuracy, SettingsError> {
    let observed = match precision {
        Precision::F32 => run::<f32>(target, solver),
        Precision::F64 => run::<f64>(target, solver),
    }?;
    Ok(accuracy(target, &observed))
}

fn run<F: Precise>(target: &ReferenceRun<'_>, solver: Solver) -> Result<Observed, SettingsError> {
    let ReferenceRun {
        scene, sampling, ..
    } = target;
    let omega = F::from_f64(scene.motion.at(0.0).omega_rad_s);
    let joint = AnyJoint::new(&scene.settings, solver, sampling.step_s(), omega)?;
    observe(target, joint)
}

/// Observations of a run.
#[derive(Debug)]
struct Observed {
    events: Vec<TimedEvent>,
    /// Number of events beyond those stored.
    more_events: u64,
    held: Errors,
    at_ticks: Errors,
    lead: Lead,
    finite: bool,
}

/// Torque errors of equal weight.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    /// Sum of the squares, (N·m)².
    squares: f64,
    max_nm: f64,
}

impl Errors {
    fn add(&mut self, square: f64, largest_nm: f64) {
        self.squares += square;
        self.max_nm = largest_nm.max(self.max_nm);
    }

    fn rms_nm(&self, steps: u64) -> f64 {
        (self.squares / f64::from_whole(steps)).sqrt()
    }
}

/// Runs a joint and observes every step.
fn observe<F: Precise>(
    target: &ReferenceRun<'_>,
    mut joint: AnyJoint<F>,
) -> Result<Observed, SettingsError> {
    let ReferenceRun {
        scene,
        sampling,
        events,
        torque,
        held,
        ..
    } = target;
    // A rung that chatters has failed already; its events need no memory.
    let most = 4 * events.len() + 10_000;
    let mut observed = Observed {
        events: Vec::new(),
        more_events: 0,
        held: Errors::default(),
        at_ticks: Errors::default(),
        lead: Lead::new(&scene.settings, sampling.step_s(), F::IS_SINGLE),
        finite: true,
    };
    let mut feed = Feed::new(scene.input, sampling, 0)?;
    let mut chunk = Vec::with_capacity(CHUNK_STEPS);
    let (mut n, mut index, mut tie) = (0_u64, 0_usize, 0_usize);
    loop {
        feed.fill(&mut chunk, CHUNK_STEPS);
        if chunk.is_empty() {
            break;
        }
        for shaft in &chunk {
            if let Some(tick) = held.tick(index) {
                let shown_nm = joint.torque_nm().to_f64();
                observed
                    .held
                    .add(tick.mean_square(shown_nm), tick.largest_nm(shown_nm));
            }
            joint.step(shaft, |event| {
                if observed.events.len() < most {
                    let time_s = sampling.time_s(n, event.fraction.to_f64());
                    observed.events.push(TimedEvent::new(time_s, &event));
                } else {
                    observed.more_events += 1;
                }
            });
            let error_nm = torque.error_nm::<F>(index, joint.torque_nm().to_f64(), &mut tie);
            observed.at_ticks.add(error_nm * error_nm, error_nm);
            if let Phase::Slip(sense) = joint.phase()
                && observed.lead.is_due()
            {
                observed.lead.look(
                    sense.of_signed(1.0),
                    shaft.omega_end_rad_s.to_f64(),
                    joint.theta_dot_rad_s().to_f64(),
                );
            }
            n += 1;
            index += 1;
        }
        // The torque of a slip is Tk even if the object is not finite.
        observed.finite &= joint.theta_rad().is_finite()
            && joint.theta_dot_rad_s().is_finite()
            && observed.at_ticks.squares.is_finite()
            && observed.held.squares.is_finite();
    }
    observed.finite &= observed.events.iter().all(|e| e.time_s.is_finite());
    Ok(observed)
}

fn accuracy(target: &ReferenceRun<'_>, observed: &Observed) -> Accuracy {
    let ReferenceRun {
        sampling, events, ..
    } = target;
    let kept = u64::try_from(observed.events.len()).unwrap_or(u64::MAX);
    let found = kept.saturating_add(observed.more_events);
    if !observed.finite {
        let all = u64::try_from(events.len()).unwrap_or(u64::MAX);
        return Accuracy {
            events: found,
            unmatched: all.saturating_add(found).max(1),
            event_errors: EventErrors::UNKNOWN,
            rms_held_torque_error_nm: f64::NAN,
            max_held_torque_error_nm: f64::NAN,
            rms_tick_torque_error_nm: f64::NAN,
            max_tick_torque_error_nm: f64::NAN,
            behind_s: f64::NAN,
            behind_j: f64::NAN,
        };
    }
    let matching = match_events(
        events,
        &observed.events,
        sampling.step_s(),
        sampling.end_s(),
    );
    Accuracy {
        events: found,
        unmatched: matching.unmatched.saturating_add(observed.more_events),
        event_errors: EventErrors::new(events, &observed.events, &matching),
        rms_held_torque_error_nm: observed.held.rms_nm(sampling.steps()),
        max_held_torque_error_nm: observed.held.max_nm,
        rms_tick_torque_error_nm: observed.at_ticks.rms_nm(sampling.steps()),
        max_tick_torque_error_nm: observed.at_ticks.max_nm,
        behind_s: observed.lead.behind_s,
        behind_j: observed.lead.behind_j,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::standard;
    use std::convert::Infallible;

    /// 1 s of a standard scene.
    fn accuracy(name: &str, convention: &str, solver: Solver, step_s: f64) -> Accuracy {
        let scene = StudyScene {
            duration_s: 1.0,
            ..standard()
                .unwrap()
                .into_iter()
                .find(|s| s.name == name && s.convention() == convention)
                .unwrap()
        };
        let truth = scene.true_events();
        let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
        let torque =
            ReferenceTorque::new(&scene, &sampling, &truth, || Ok::<_, Infallible>(())).unwrap();
        let events: Vec<_> = truth.iter().map(|e| e.event).collect();
        let target = ReferenceRun {
            scene: &scene,
            sampling: &sampling,
            events: &events,
            torque: &torque,
            held: &HeldTorque::new(&scene, &sampling, &truth),
        };
        measure(&target, solver, Precision::F64).unwrap()
    }

    #[test]
    fn exact_events_are_exact() {
        for (name, convention) in [
            ("constant-0.5", "frozen"),
            ("constant-0.988", "physical"),
            ("constant-2", "physical"),
        ] {
            let a = accuracy(name, convention, Solver::ExactEvents, 2e-4);
            assert_eq!(a.unmatched, 0);
            assert!(a.events > 60, "{a:?}");
            assert!(a.event_errors.max_s < 1e-12, "{a:?}");
            assert!(a.max_tick_torque_error_nm < 1e-9, "{a:?}");
        }
    }

    #[test]
    fn without_location_events_are_a_step_late_and_the_torque_jumps() {
        let a = accuracy("constant-0.988", "physical", Solver::Exact, 5e-5);
        assert_eq!(a.unmatched, 0);
        assert!(
            a.event_errors.max_s > 1e-5 && a.event_errors.max_s < 5e-3,
            "{a:?}"
        );
        assert!(a.max_tick_torque_error_nm > 0.1, "{a:?}");
        assert!(
            a.rms_tick_torque_error_nm < a.max_tick_torque_error_nm / 5.0,
            "{a:?}"
        );
    }
}

//! Orders of convergence by kind of motion: a constant speed, a sine, minimum-jerk
//! strokes and a recorded knee, under each convention.
//!
//! The headline orders of the ladder are those of a constant speed, where a path
//! within a step with linear Ω is exact. A hand's Ω bends, and under
//! `physical` its Ω̇ is in the torque of a stick, so there a rung has the order of
//! its path. Only events are compared: nothing is timed, and every rung computes
//! in f64.

use crate::accuracy::hands::hands;
use crate::accuracy::input::Input;
use crate::accuracy::orders::{Orders, order, shortest_step_s};
use crate::accuracy::scenes::{StudyScene, paper};
use crate::event_errors::EventErrors;
use crate::matching::match_events;
use crate::sampling::{CHUNK_STEPS, Sampling};
use crate::true_events::TimedEvent;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, SettingsError, StickSlip};
use crepitus_plant::Motion;
use crepitus_scene::any_joint::AnyJoint;

/// The longest step, s: a quarter of the shortest slip.
const LONGEST_STEP_S: f64 = 4e-3;

/// Each step over the one before: no two are commensurate, with each other or
/// with a cycle.
const RATIO: f64 = 0.8;

/// Number of steps; the shortest is 24 µs.
const STEPS: i32 = 24;

/// Duration of each motion, s.
const DURATION_S: f64 = 4.0;

/// One rung at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// The step, s.
    pub step_s: f64,
    /// Interior events of either side without a partner.
    pub unmatched: u64,
    /// Errors of the matched events.
    pub errors: EventErrors,
}

/// The motions, each under every convention; at a constant speed `paper` is
/// `physical`.
///
/// # Errors
/// None in practice: the paper's settings are valid under every convention.
pub fn motions() -> Result<Vec<StudyScene>, SettingsError> {
    let speed = ("constant-speed", "0.988 rad/s", Motion::constant(0.988));
    let sine = (
        "sine",
        "45° at 0.25 Hz, from rest",
        Motion::sine(45_f64.to_radians(), 0.25, -90.0),
    );
    let names = ["strokes", "recorded-knee"];
    let hands = names
        .into_iter()
        .zip(hands())
        .map(|(name, (_, title, motion))| (name, title, motion));
    let motions = [speed, sine].into_iter().chain(hands);
    let mut scenes = Vec::new();
    for (name, title, motion) in motions {
        for convention in Convention::ALL {
            if name == "constant-speed" && convention == Convention::Paper {
                continue;
            }
            scenes.push(StudyScene {
                name: name.to_owned(),
                title: title.to_owned(),
                motion: motion.clone(),
                duration_s: DURATION_S,
                settings: paper(convention)?,
                input: Input::Exact,
            });
        }
    }
    Ok(scenes)
}

/// The orders of every rung on these scenes.
///
/// # Errors
/// Settings that cannot work together.
pub fn orders_on(scenes: &[StudyScene]) -> Result<Vec<Orders>, SettingsError> {
    let mut all = Vec::new();
    for scene in scenes {
        for solver in Solver::ALL {
            if solver.refusal(scene.settings.convention).is_some() {
                continue;
            }
            let mut runs = runs(scene, solver)?;
            let shortest_s = shortest_step_s(solver.name());
            runs.retain(|run| run.unmatched == 0 && run.step_s >= shortest_s);
            let order_of = |error: fn(&EventErrors) -> f64| {
                let errors: Vec<_> = runs.iter().map(|r| (r.step_s, error(&r.errors))).collect();
                order(&errors)
            };
            all.push(Orders {
                scene: scene.name.clone(),
                convention: scene.convention(),
                solver: solver.name(),
                frequency: order_of(|e| e.frequency_rel),
                event_time: order_of(|e| e.max_s),
                event_time_rms: order_of(|e| e.rms_s),
            });
        }
    }
    Ok(all)
}

/// A rung on a scene at each step, the longest first.
///
/// # Errors
/// As [`orders_on`].
pub fn runs(scene: &StudyScene, solver: Solver) -> Result<Vec<Run>, SettingsError> {
    let truth: Vec<TimedEvent> = scene.true_events().iter().map(|e| e.event).collect();
    (0..STEPS)
        .map(|n| run_at(scene, &truth, solver, LONGEST_STEP_S * RATIO.powi(n)))
        .collect()
}

/// A rung on a scene at one step, against the `truth` of the scene.
///
/// # Errors
/// As [`orders_on`].
pub fn run_at(
    scene: &StudyScene,
    truth: &[TimedEvent],
    solver: Solver,
    step_s: f64,
) -> Result<Run, SettingsError> {
    let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
    let omega = scene.motion.at(0.0).omega_rad_s;
    let collect = Collect {
        sampling: &sampling,
        // A rung that chatters has failed already.
        most: 4 * truth.len() + 10_000,
    };
    let found = collect.events(AnyJoint::new(&scene.settings, solver, step_s, omega)?);
    let matching = match_events(truth, &found, step_s, sampling.end_s());
    Ok(Run {
        step_s,
        unmatched: matching.unmatched,
        errors: EventErrors::new(truth, &found, &matching),
    })
}

/// The events of a run.
struct Collect<'a> {
    sampling: &'a Sampling<'a>,
    most: usize,
}

impl Collect<'_> {
    fn events(&self, mut joint: AnyJoint<f64>) -> Vec<TimedEvent> {
        let mut events = Vec::new();
        let mut walk = self.sampling.walk_from(0);
        let mut chunk = Vec::with_capacity(CHUNK_STEPS);
        let mut n = 0;
        loop {
            walk.fill(&mut chunk, CHUNK_STEPS);
            if chunk.is_empty() {
                return events;
            }
            for shaft in &chunk {
                joint.step(shaft, |event| {
                    if events.len() < self.most {
                        let time_s = self.sampling.time_s(n, event.fraction);
                        events.push(TimedEvent::new(time_s, &event));
                    }
                });
                n += 1;
            }
        }
    }
}

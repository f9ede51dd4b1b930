//! Inputs for the target.
//!
//! | input | content | for |
//! |---|---|---|
//! | a scene | the part that is timed on the host, too | all; means are over these |
//! | `wander` | a hand that wanders: breaks, matches, reversals in stick and in slip | all |
//! | `shaking hand` | 50 Hz, to and fro within a stick and its slip | all |
//! | `white velocities` | every step ends at another velocity, up to 5 rad/s: the largest jump that the input check accepts | all |
//! | `gaps` | `wander` with samples missing, one to six at a time, and some implausible ones | subjects with an input check |
//! | `commits` | `wander` while the parameters change and change back | the renderer |
//! | `extremes` | numbers at and beyond every limit | effects |
//!
//! The effects get their inputs in the device: counts of the encoder, jumps of
//! the rendered torque, the commanded current. Symptoms depend on the joint's angle:
//! they have motions and hard inputs of their own, see `symptoms`.

mod device;
mod symptoms;

use crate::accuracy::scenes::StudyScene;
use crate::sampling::Sampling;
use crate::stability::catalogue::WANDER;
use crate::stability::input::{Input as Hard, Shaft, What};
use crate::stability::replay::steps;
use crepitus_ladder::exchange::Input;
use crepitus_ladder::{Plan, Subject};
use crepitus_model::{SettingsError, ShaftStep};

/// The device's tick, s.
pub const TICK_S: f64 = 5e-5;

/// Largest speed of white velocities, rad/s: from one sense to the other it is the largest change that
/// the input check accepts.
const WHITE_RAD_S: f64 = 5.0;

/// Number of steps of each input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lengths {
    /// Steps of a scene.
    pub scene: u32,
    /// Steps of a hard input.
    pub hard: u32,
}

impl Lengths {
    /// A full study.
    pub const FULL: Self = Self {
        scene: 4_000,
        hard: 21_000,
    };

    /// A quick one.
    pub const QUICK: Self = Self {
        scene: 1_000,
        hard: 4_000,
    };
}

/// A plan and its inputs.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// Name of the input.
    pub name: String,
    /// The scene that it is a part of.
    pub scene: Option<&'a StudyScene>,
    /// The mean is over these.
    pub is_usual: bool,
    /// The plan.
    pub plan: Plan,
    /// Inputs of the plan.
    pub inputs: Vec<Input>,
}

/// A motion of the shaft in steps of the device's tick.
type Motion = Vec<ShaftStep<f32>>;

/// The tasks of a subject: the scenes of its convention, and hard inputs. What
/// has no joint gets the scenes under the convention of the first.
///
/// # Errors
/// None in practice: the paper's parameters and the encoder are allowed.
pub fn tasks(
    subject: Subject,
    scenes: &[StudyScene],
    lengths: Lengths,
) -> Result<Vec<Task<'_>>, SettingsError> {
    if symptoms::is_symptom(subject) {
        return symptoms::tasks(subject, lengths);
    }
    let first = scenes.first().map(|scene| scene.settings.convention);
    let convention = subject.convention().or(first);
    let mut tasks = Vec::new();
    for scene in scenes {
        if Some(scene.settings.convention) == convention {
            let motion = stretch(scene, lengths.scene);
            let plan = Plan {
                parameters: [scene.settings.parameters; 2],
                restart: scene.settings.restart,
                ..plan(subject, &motion)
            };
            tasks.push(Task {
                name: scene.name.clone(),
                scene: Some(scene),
                is_usual: true,
                plan,
                inputs: device::usual(&plan, &motion)?,
            });
        }
    }
    let hard = |name: &str, plan, inputs| Task {
        name: name.to_owned(),
        scene: None,
        is_usual: false,
        plan,
        inputs,
    };
    let motions = motions(lengths.hard)?;
    for (name, motion) in &motions {
        let plan = plan(subject, motion);
        tasks.push(hard(name, plan, device::usual(&plan, motion)?));
    }
    let Some((_, wander)) = motions.first() else {
        return Ok(tasks);
    };
    let plan = plan(subject, wander);
    match subject {
        Subject::Rung(..) | Subject::Law(_) => {}
        Subject::Checked(_) => tasks.push(hard("gaps", plan, device::gaps(wander))),
        Subject::Renderer => {
            tasks.push(hard("gaps", plan, device::gaps(wander)));
            let (plan, inputs) = device::commits(&plan, wander);
            tasks.push(hard("commits", plan, inputs));
        }
        _ => tasks.push(hard("extremes", plan, device::extremes())),
    }
    Ok(tasks)
}

/// A subject that starts as a motion does, with the paper's parameters.
fn plan(subject: Subject, motion: &[ShaftStep<f32>]) -> Plan {
    Plan {
        step_s: TICK_S,
        omega_rad_s: motion.first().map_or(0.0, |step| step.omega_start_rad_s),
        ..Plan::of(subject)
    }
}

/// The part around the end of a scene's first quarter, as timed on the host.
fn stretch(scene: &StudyScene, length: u32) -> Motion {
    let sampling = Sampling::new(&scene.motion, scene.duration_s, TICK_S);
    let length = sampling.steps().min(length.into());
    let start = (sampling.steps() / 4).saturating_sub(length / 2);
    let mut motion = Vec::new();
    let most = usize::try_from(length).unwrap_or(usize::MAX);
    sampling.walk_from(start).fill(&mut motion, most);
    motion
}

/// Motions for the worst step; the first covers all phases.
fn motions(length: u32) -> Result<Vec<(&'static str, Motion)>, SettingsError> {
    let duration_s = |seconds: f64| seconds.min(f64::from(length) * TICK_S);
    let sampled = |shaft, seconds| Hard::sampled(shaft, duration_s(seconds), TICK_S);
    let shaking = Shaft::Sine(1.4e-3, 50.0, 0.0);
    let white = What::White {
        most_rad_s: WHITE_RAD_S,
        seed: 1,
    };
    let white = Hard::new(white, duration_s(0.2), TICK_S);
    Ok(vec![
        ("wander", steps(&sampled(Shaft::Knots(WANDER), 1.05))?),
        ("shaking hand", steps(&sampled(shaking, 0.2))?),
        ("white velocities", steps(&white)?),
    ])
}

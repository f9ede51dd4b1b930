//! Plan of the study that the command line asks for.

use super::Arguments;
use crate::failure::Failure;
use crepitus_model::Convention;
use crepitus_scene::Overrides;
use crepitus_scene::scene::Precision;
use crepitus_scene::shipped;
use crepitus_studies::accuracy::steps::{FULL_STEPS_S, QUICK_STEPS_S};
use crepitus_studies::accuracy::study::{FULL_REPEATS, QUICK_REPEATS};
use crepitus_studies::accuracy::target::inputs::TICK_S;
use crepitus_studies::accuracy::{Plan, StudyScene, scenes};

/// Rates that a device or a simulation may have, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 10.0..=1e6;

/// A plan, and what of it a need is for.
pub(super) struct Studied {
    pub(super) plan: Plan,
    /// The convention of the need.
    pub(super) convention: Convention,
    /// The precision of the need.
    pub(super) precision: Precision,
    /// The one step of the need, s.
    pub(super) step_s: Option<f64>,
}

pub(super) fn plan(arguments: &Arguments) -> Result<Studied, Failure> {
    let mut scenes = scenes(arguments)?;
    let convention = convention(arguments, &scenes)?;
    let precision = if arguments.precision == Precision::F64.name() {
        Precision::F64
    } else {
        Precision::F32
    };
    let step_s = step_s(arguments, precision)?;
    let mut steps_s = steps(arguments)?;
    let mut precisions = vec![Precision::F32, Precision::F64];
    if arguments.need.is_some() && arguments.out.is_none() {
        // Only an answer is asked for: study what it needs.
        scenes.retain(|s| s.settings.convention == convention);
        precisions = vec![precision];
        if step_s.is_some() {
            steps_s.clear();
        }
    }
    steps_s.extend(step_s);
    Ok(Studied {
        plan: Plan {
            scenes,
            steps_s,
            precisions,
            repeats: if arguments.quick {
                QUICK_REPEATS
            } else {
                FULL_REPEATS
            },
        },
        convention,
        precision,
        step_s,
    })
}

fn scenes(arguments: &Arguments) -> Result<Vec<StudyScene>, Failure> {
    let Some(path) = &arguments.scene else {
        // A need is for the paper's joint on its true motion; of another one it is asked with --scene.
        let scenes = match arguments.need {
            Some(_) => scenes::standard(),
            None => scenes::full(),
        };
        return scenes
            .map_err(|e| Failure::Work(format!("the standard scenes are not valid: {e}")));
    };
    let scene = shipped::scene(path, &Overrides::default())?;
    match StudyScene::of(&scene) {
        Some(scene) => Ok(vec![scene]),
        None => Err(Failure::Input(format!(
            "{}: the scene has no [effects.crepitus], so there is nothing to solve",
            path.display()
        ))),
    }
}

/// The convention that a need is for.
fn convention(arguments: &Arguments, scenes: &[StudyScene]) -> Result<Convention, Failure> {
    let here = |c: Convention| scenes.iter().any(|s| s.settings.convention == c);
    let Some(name) = &arguments.convention else {
        return Ok(match scenes {
            [only] => only.settings.convention,
            _ => Convention::default(),
        });
    };
    let allowed: Vec<_> = Convention::ALL.into_iter().filter(|c| here(*c)).collect();
    allowed
        .iter()
        .copied()
        .find(|c| c.name() == name)
        .ok_or_else(|| {
            let names: Vec<_> = allowed.iter().map(|c| c.name()).collect();
            Failure::Input(format!(
                "--convention {name}: {} studied under {}",
                if scenes.len() == 1 {
                    "this scene is"
                } else {
                    "the scenes are"
                },
                names.join(", ")
            ))
        })
}

/// The one step of the need. Where the target chooses, that of its tick.
fn step_s(arguments: &Arguments, precision: Precision) -> Result<Option<f64>, Failure> {
    let step_s = arguments.rate.map(step_of).transpose()?;
    if !(arguments.target && arguments.need.is_some()) {
        return Ok(step_s);
    }
    if precision != Precision::F32 {
        return Err(Failure::Input(
            "--need --target: the target computes in f32; leave --precision out".to_owned(),
        ));
    }
    match step_s {
        Some(step_s) if (step_s - TICK_S).abs() > 1e-6 * TICK_S => Err(Failure::Input(format!(
            "--need --target: the cycles of a step are those of the device's tick; expected --rate {:.0} or no --rate",
            1.0 / TICK_S
        ))),
        Some(step_s) => Ok(Some(step_s)),
        None => Ok(Some(TICK_S)),
    }
}

fn step_of(rate_hz: f64) -> Result<f64, Failure> {
    if RATES_HZ.contains(&rate_hz) {
        Ok(1.0 / rate_hz)
    } else {
        Err(Failure::Input(format!(
            "--rate {rate_hz}: a rate from {} to {:e} Hz is allowed",
            RATES_HZ.start(),
            RATES_HZ.end()
        )))
    }
}

fn steps(arguments: &Arguments) -> Result<Vec<f64>, Failure> {
    if let Some(bad) = arguments
        .steps
        .iter()
        .find(|h| !(**h >= 1e-7 && **h <= 1.0))
    {
        return Err(Failure::Input(format!(
            "--steps {bad}: steps from 1e-7 to 1 s are allowed"
        )));
    }
    Ok(if !arguments.steps.is_empty() {
        arguments.steps.clone()
    } else if arguments.quick {
        QUICK_STEPS_S.to_vec()
    } else {
        FULL_STEPS_S.to_vec()
    })
}

//! Studies of a scene, as the tables that the tool writes, in JSON.

use crate::errors;
use crate::scene::Scene;
use crate::signals::Watch;
use crepitus_pages::table::Table;
use crepitus_scene::scene::Precision;
use crepitus_studies::accuracy::points_table::points_table;
use crepitus_studies::accuracy::steps::{FULL_STEPS_S, QUICK_STEPS_S};
use crepitus_studies::accuracy::study::{FULL_REPEATS, QUICK_REPEATS};
use crepitus_studies::accuracy::{Plan, StudyScene, run, scenes::standard};
use crepitus_studies::effects::effects_table::effects_table;
use crepitus_studies::effects::{EffectsError, Plan as EffectsPlan, run as run_effects};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Range of the step of a study, s.
const STEPS_S: std::ops::RangeInclusive<f64> = 1e-7..=1.0;

/// Runs the work-precision study of a scene, or of the standard ones; returns its points.
#[pyfunction]
#[pyo3(signature = (scene, *, steps_s, quick))]
pub(crate) fn accuracy(
    py: Python<'_>,
    scene: Option<&Scene>,
    steps_s: Option<Vec<f64>>,
    quick: bool,
) -> PyResult<String> {
    let scenes = match scene {
        Some(scene) => {
            let studied = StudyScene::of(&scene.checked);
            let nothing = "the scene has no [effects.crepitus], so there is nothing to solve";
            vec![studied.ok_or_else(|| scene.refused("effects.crepitus", nothing.to_owned()))?]
        }
        None => standard().map_err(|e| errors::run(e.to_string()))?,
    };
    let (steps, repeats) = if quick {
        (QUICK_STEPS_S.to_vec(), QUICK_REPEATS)
    } else {
        (FULL_STEPS_S.to_vec(), FULL_REPEATS)
    };
    let steps_s = steps_s.unwrap_or(steps);
    if let Some(bad) = steps_s.iter().find(|step| !STEPS_S.contains(step)) {
        return Err(PyValueError::new_err(format!(
            "steps_s: expected steps from {:e} to {} s, got {bad}",
            STEPS_S.start(),
            STEPS_S.end()
        )));
    }
    let plan = Plan {
        scenes,
        steps_s,
        precisions: vec![Precision::F32, Precision::F64],
        repeats,
    };
    let study = py.detach(|| {
        let mut watch = Watch::new();
        run(&plan, &mut watch)
            .map_err(|error| watch.raised_or(|| errors::run(format!("the study failed: {error}"))))
    })?;
    json(&points_table(&study.points))
}

/// Runs the study of effects: the change of the torque at the hand by each effect of a scene, and
/// its cost.
#[pyfunction]
pub(crate) fn effects(py: Python<'_>, scene: &Scene) -> PyResult<String> {
    let plan = EffectsPlan {
        scene: scene.checked.clone(),
        tolerance: None,
    };
    let study = py.detach(|| {
        let mut watch = Watch::new();
        run_effects(&plan, &mut watch).map_err(|error| {
            watch.raised_or(|| match error {
                EffectsError::Refused(refusal) => scene.refused(refusal.key(), refusal.to_string()),
                other => errors::run(format!("{}: {other}", scene.checked.file.display())),
            })
        })
    })?;
    json(&effects_table(&study.rows))
}

fn json<R>(table: &Table<'_, R>) -> PyResult<String> {
    serde_json::to_string(table).map_err(|error| errors::run(error.to_string()))
}

//! What ships: scenes, presets, and a device's parameters, as JSON.

use crate::errors;
use crepitus_connection::parameters::described;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_scene::shipped::SHIPPED;
use crepitus_scene::{Overrides, preset};
use pyo3::prelude::*;
use serde_json::{Value, json};

/// The scenes that ship.
#[pyfunction]
pub(crate) fn scenes() -> PyResult<String> {
    let scenes = SHIPPED
        .iter()
        .map(|shipped| {
            let scene = shipped.read(&Overrides::default())?;
            let effects: Vec<_> = scene.effects().iter().map(|e| e.name).collect();
            Ok(json!({
                "name": shipped.name,
                "title": scene.title,
                "description": scene.description,
                "duration_s": scene.duration_s,
                "motion": scene.motion_kind.name(),
                "solver": scene.solver.name(),
                "effects": effects,
            }))
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| errors::scene(error, false))?;
    Ok(Value::Array(scenes).to_string())
}

/// The presets that ship.
#[pyfunction]
pub(crate) fn presets() -> String {
    let presets = preset::shipped().iter().map(|preset| preset.to_json(None));
    Value::Array(presets.collect()).to_string()
}

/// A device's parameters.
#[pyfunction]
pub(crate) fn parameters() -> String {
    Value::Array(PARAMETERS.iter().map(described).collect()).to_string()
}

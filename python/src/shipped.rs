//! Scenes and presets that ship, and the parameters of a device, as JSON.

use crate::errors;
use crepitus_client::connection::parameters::described;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_scene::shipped::SHIPPED;
use crepitus_scene::{Overrides, preset};
use pyo3::prelude::*;
use serde_json::{Value, json};

/// Returns the scenes that ship.
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

/// Returns the presets that ship.
#[pyfunction]
pub(crate) fn presets() -> String {
    let presets = preset::shipped().iter().map(|preset| preset.to_json(None));
    Value::Array(presets.collect()).to_string()
}

/// Returns the parameters of a device.
#[pyfunction]
pub(crate) fn parameters() -> String {
    Value::Array(PARAMETERS.iter().map(described).collect()).to_string()
}

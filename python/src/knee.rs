//! Knees for a device: a preset, or the effects of a scene.

use crate::errors;
use crepitus_scene::preset::{self, Knee};
use crepitus_scene::shipped::Shipped;
use crepitus_scene::{Overrides, Preset, similar};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::Path;

/// Finds a knee by name: a preset that ships, a file of either kind, or a scene that ships, in this
/// order.
pub(crate) fn knee(what: &Path) -> PyResult<Knee> {
    if let Some(preset) = what.to_str().and_then(preset::find) {
        return Ok(Knee::Preset(Box::<Preset>::new(preset.clone())));
    }
    let failed = |error| errors::scene(error, false);
    if what.exists() && Shipped::meant_by(what).is_none() {
        return Knee::read(what).map_err(failed);
    }
    if let Some(shipped) = Shipped::find(what) {
        let scene = shipped.read(&Overrides::default()).map_err(failed)?;
        return Ok(Knee::Scene(Box::new(scene)));
    }
    let name = what.to_string_lossy();
    let meant = similar::preset(&name).or_else(|| similar::scene(&name));
    Err(PyValueError::new_err(format!(
        "{name}: there is no such file, no such preset and no such scene{}: crepitus.presets() and \
         crepitus.scenes() list those that ship",
        similar::question(meant)
    )))
}

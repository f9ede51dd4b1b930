//! Knees for a device: a preset, or the effects of a scene.

use crate::errors;
use crepitus_scene::preset;
use crepitus_scene::shipped::{self, Shipped};
use crepitus_scene::similar::question;
use crepitus_scene::{Knee, Overrides, Preset};
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
    let meant = preset::similar_name(&name).or_else(|| shipped::similar_name(&name));
    Err(PyValueError::new_err(format!(
        "{name}: there is no such file, no such preset and no such scene{}: crepitus.presets() and \
         crepitus.scenes() list those that ship",
        question(meant)
    )))
}

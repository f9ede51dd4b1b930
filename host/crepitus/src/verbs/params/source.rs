//! Sources of parameters: a preset, a scene, or a file of either kind.

use crate::failure::Failure;
use crate::own_presets;
use crepitus_protocol::Values;
use crepitus_scene::preset::{self, Preset};
use crepitus_scene::shipped::{self, Shipped};
use crepitus_scene::similar::question;
use crepitus_scene::values::{with_preset, with_scene};
use crepitus_scene::{Knee, Overrides, Scene};
use std::path::Path;

/// A preset or a scene.
pub(super) enum Source {
    Preset(Box<Preset>),
    Scene(Box<Scene>),
}

impl Source {
    /// A preset that ships, one of the user's own, a file, or a scene that ships: the
    /// first of this name.
    pub(super) fn find(what: &Path) -> Result<Self, Failure> {
        let name = what.to_str();
        if let Some(preset) = name.and_then(preset::find) {
            return Ok(Self::Preset(Box::new(preset.clone())));
        }
        if let Some(file) = name.and_then(own_presets::find) {
            let preset = Preset::read(&file).map_err(Failure::input)?;
            return Ok(Self::Preset(Box::new(preset)));
        }
        let is_summary = what.extension().is_some_and(|e| e == "json");
        let shipped = Shipped::meant_by(what);
        if what.exists() && !is_summary && shipped.is_none() {
            return match Knee::read(what).map_err(Failure::input)? {
                Knee::Preset(preset) => Ok(Self::Preset(preset)),
                Knee::Scene(scene) => Ok(Self::Scene(scene)),
            };
        }
        if let Some(text) = name.and_then(own_presets::grade_0) {
            return Err(Failure::Input(text));
        }
        if !is_summary && shipped.is_none() {
            let presets = name.map(own_presets::suggestions);
            let alike = presets
                .filter(|text| !text.is_empty())
                .unwrap_or_else(|| question(name.and_then(shipped::similar_name)));
            return Err(Failure::Input(format!(
                "{}: there is no such file, no such preset and no such scene{alike}: `crepitus presets` and \
                 `crepitus scenes` list those that ship",
                what.display()
            )));
        }
        let scene = shipped::scene(what, &Overrides::default())?;
        Ok(Self::Scene(Box::new(scene)))
    }

    /// The values of a device that gets it.
    pub(super) fn on(&self, now: &Values, keeps_others: bool) -> Result<Values, Failure> {
        match self {
            Self::Preset(preset) => Ok(with_preset(now, preset, keeps_others)),
            Self::Scene(_) if keeps_others => Err(Failure::input(
                "--add needs a preset: a scene says which effects there are, and which not",
            )),
            Self::Scene(scene) => with_scene(now, scene).map_err(Failure::input),
        }
    }
}

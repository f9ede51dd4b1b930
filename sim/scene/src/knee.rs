//! Content of a file that may be a scene or a preset.

use crate::document::{Document, text_of};
use crate::error::SceneError;
use crate::preset::Preset;
use crate::scene::{Overrides, Scene};
use std::path::Path;

/// Content of a file: a scene, which has a `version`, or a preset.
#[derive(Clone, Debug)]
pub enum Knee {
    /// A scene.
    Scene(Box<Scene>),
    /// A preset.
    Preset(Box<Preset>),
}

impl Knee {
    /// Reads and checks a file of either kind.
    ///
    /// # Errors
    /// As [`Preset::read`].
    pub fn read(file: &Path) -> Result<Self, SceneError> {
        let text = text_of(file)?;
        let document = Document::parse(file, &text)?;
        let root = document.section();
        if root.has("version") {
            let scene = Scene::parse(file, &text, &Overrides::default())?;
            return Ok(Self::Scene(Box::new(scene)));
        }
        // No preset has them, so the line was forgotten.
        if root.has("motion") || root.has("solver") {
            return Err(root.key_error(
                "version",
                "this key is missing: a file with `motion` or `solver` is a scene, and a scene needs `version = 1` as \
                 its first line",
            ));
        }
        Ok(Self::Preset(Box::new(Preset::parse(file, &text)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_whose_version_was_forgotten_is_no_wrong_preset() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        for tables in ["[motion]\n", "[solver]\n"] {
            std::fs::write(&file, format!("description = \"x\"\n{tables}")).unwrap();
            let error = Knee::read(&file).unwrap_err().to_string();
            assert!(error.contains("needs `version = 1`"), "{error}");
        }
        std::fs::write(&file, "[effects.clonus]\n").unwrap();
        assert!(matches!(Knee::read(&file), Ok(Knee::Preset(_))));
    }
}

//! The scenes that ship, embedded in the program.

use crate::failure::Failure;
use crepitus_scene::{Overrides, Scene, SceneError};
use std::path::{Path, PathBuf};

/// A scene that ships.
pub(crate) struct Shipped {
    /// File name without `.toml`.
    pub(crate) name: &'static str,
    /// The file.
    pub(crate) text: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        /// All of them, in the order of a first visit.
        pub(crate) const SHIPPED: &[Shipped] = &[$(Shipped {
            name: $name,
            text: include_str!(concat!("../../../scenes/", $name, ".toml")),
        }),*];
    };
}

shipped![
    "fig6-ideal-cycle",
    "slow-examination",
    "low-speed",
    "high-speed",
    "tardieu-fast",
    "reversal-inside-stick",
    "presliding",
    "knee-pass-frozen",
    "knee-pass-physical",
    "restart-elastic",
    "restart-from-kinetic",
    "preset-coarse",
    "preset-fine",
    "preset-bone-on-bone",
    "encoder",
    "fig8-1-motor",
    "fig8-2-drivetrain",
    "fig8-3-cuff",
    "fig8-4-limb",
    "fig8-5-hand",
    "fig9-low-speed",
    "gear-friction",
    "backlash-reversal",
    "cuff-transmission",
    "bone-shaping",
    "pendulum-test",
    "everything",
    "passive-examination",
];

impl Shipped {
    /// The scene of this name.
    pub(crate) fn find(name: &Path) -> Option<&'static Self> {
        let name = name.to_str()?;
        SHIPPED.iter().find(|s| s.name == name)
    }

    /// Where the file stands in the repository.
    pub(crate) fn file(&self) -> PathBuf {
        PathBuf::from(format!("scenes/{}.toml", self.name))
    }

    /// The scene, read.
    pub(crate) fn read(&self, overrides: &Overrides) -> Result<Scene, SceneError> {
        Scene::parse(&self.file(), self.text, overrides)
    }
}

/// The scene of an argument: a file, or the name of a scene that ships.
pub(crate) fn scene(path: &Path, overrides: &Overrides) -> Result<Scene, Failure> {
    if path.exists() {
        return Scene::read(path, overrides).map_err(Failure::input);
    }
    match Shipped::find(path) {
        Some(shipped) => shipped.read(overrides).map_err(Failure::input),
        None => Err(Failure::Input(format!(
            "{}: there is no such file, and no such scene ships: `crepitus scenes` lists those that do",
            path.display()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_in_the_folder_ships_and_reads() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().path())
            .filter(|p| p.extension().is_some_and(|e| e == "toml"))
            .map(|p| p.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        files.sort();
        let mut names: Vec<_> = SHIPPED.iter().map(|s| s.name.to_owned()).collect();
        names.sort();
        assert_eq!(files, names);
        for shipped in SHIPPED {
            let scene = shipped.read(&Overrides::default()).unwrap();
            assert!(
                scene.description.is_some(),
                "{} explains nothing",
                shipped.name
            );
        }
    }
}

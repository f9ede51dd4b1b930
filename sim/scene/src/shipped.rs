//! The scenes that ship, embedded in the program.

use crate::document::text_of;
use crate::error::{Origin, SceneError};
use crate::scene::{Overrides, Scene};
use crate::similar::{question, similar};
use crepitus_plant::effects::hand;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A scene that ships.
#[derive(Clone, Copy, Debug)]
pub struct Shipped {
    /// File name without `.toml`.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal)*) => {
        /// All of them, in the order of a first visit.
        pub const SHIPPED: &[Shipped] = &[$(Shipped {
            name: $name,
            text: include_str!(concat!("../../../scenes/", $name, ".toml")),
        }),*];
    };
}

shipped! {
    "fig6-ideal-cycle" "slow-examination" "low-speed" "high-speed" "tardieu-fast"
    "reversal-inside-stick" "presliding" "knee-pass-frozen" "knee-pass-physical" "restart-elastic"
    "restart-from-kinetic" "preset-coarse" "preset-fine" "preset-bone-on-bone" "encoder"
    "fig8-1-motor" "fig8-2-drivetrain" "fig8-3-compensation" "fig8-4-cuff" "fig8-5-limb" "fig8"
    "fig8-6-actuator" "fig9" "gear-friction" "backlash-reversal" "cuff-transmission" "bone-shaping"
    "pendulum-test" "limb-stretch" "end-feel-capsular" "end-feel-hard" "end-feel-springy"
    "lead-pipe-examination" "cogwheel-examination" "spasticity-tardieu" "spasticity-catch-angles"
    "spasticity-reflex" "clasp-knife-examination" "clonus-hold" "texture-there-and-back"
    "rigid-and-contracted" "catch-and-clonus" "crepitus-into-a-wall" "pressed-into-a-hard-end"
    "pendulum-mas-0" "pendulum-mas-1" "pendulum-mas-1-plus" "pendulum-mas-2" "pendulum-mas-3"
    "pendulum-mas-4" "everything" "passive-examination" "actuator-in-a-vice" "weight-in-the-brace"
    "weight-on-the-arm"
}

impl Shipped {
    /// The scene of this name.
    pub fn find(name: &Path) -> Option<&'static Self> {
        let name = name.to_str()?;
        SHIPPED.iter().find(|s| s.name == name)
    }

    /// The scene of this name, unless it is that of a file, which goes first; a folder does not.
    pub fn meant_by(path: &Path) -> Option<&'static Self> {
        Self::find(path).filter(|_| !path.is_file())
    }

    /// Path of the file in the repository.
    pub fn file(&self) -> PathBuf {
        PathBuf::from(format!("scenes/{}.toml", self.name))
    }

    /// The scene, read.
    ///
    /// # Errors
    /// The error that the overrides cause.
    pub fn read(&self, overrides: &Overrides) -> Result<Scene, SceneError> {
        Scene::parse(&self.file(), self.text, overrides)
    }
}

/// Source of a scene that is not yet read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file that errors name, and from which the path of a recording is relative.
    pub file: PathBuf,
    /// Text of the file.
    pub text: String,
    /// The run that is repeated.
    repeated: Option<Repeated>,
}

/// A run that is repeated.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Repeated {
    summary: PathBuf,
    /// SHA-256 of the recording that it was given.
    data_sha256: Option<String>,
    /// Version of the program.
    version: Option<String>,
    commit: Option<String>,
}

impl Source {
    /// Finds what an argument names: a file, a scene that ships, or the summary of a run,
    /// which is repeated.
    ///
    /// # Errors
    /// [`SceneError`]: there is no such file and no such name, or it cannot be read.
    pub fn find(path: &Path) -> Result<Self, SceneError> {
        if path
            .extension()
            .is_some_and(|extension| extension == "json")
        {
            return Self::of_summary(path);
        }
        if let Some(shipped) = Shipped::meant_by(path) {
            return Ok(Self::of_text(shipped.file(), shipped.text.to_owned()));
        }
        if !path.exists() {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let meant = question(similar_name(&stem));
            return Err(whole(
                path,
                format!(
                    "there is no such file, and no such scene ships{meant}: `crepitus scenes` lists those that do"
                ),
            ));
        }
        Ok(Self::of_text(path.to_owned(), text_of(path)?))
    }

    /// The text of a scene; `file` names it.
    pub const fn of_text(file: PathBuf, text: String) -> Self {
        Self {
            file,
            text,
            repeated: None,
        }
    }

    /// The scene of a run, from its summary.
    fn of_summary(path: &Path) -> Result<Self, SceneError> {
        let text = text_of(path)?;
        let summary: Value = serde_json::from_str(&text)
            .map_err(|e| whole(path, format!("this is not the summary of a run: {e}")))?;
        let (Some(toml), Some(file)) =
            (summary["scene_as_run"].as_str(), summary["scene"].as_str())
        else {
            return Err(whole(
                path,
                "this is not the summary of a run: `scene` or `scene_as_run` is missing",
            ));
        };
        let word = |value: &Value| value.as_str().map(str::to_owned);
        Ok(Self {
            file: file.into(),
            text: toml.to_owned(),
            repeated: Some(Repeated {
                summary: path.to_owned(),
                data_sha256: word(&summary["data"]["sha256"]),
                version: word(&summary["crepitus_version"]),
                commit: word(&summary["crepitus_commit"]),
            }),
        })
    }

    /// Commit of the program that the repeated run was of.
    pub fn commit(&self) -> Option<&str> {
        self.repeated.as_ref()?.commit.as_deref()
    }

    /// The scene, read and checked.
    ///
    /// # Errors
    /// As [`Scene::parse`]; or the recording is not the one of the run that is repeated.
    pub fn scene(&self, overrides: &Overrides) -> Result<Scene, SceneError> {
        let scene = Scene::parse(&self.file, &self.text, overrides);
        let Some(repeated) = &self.repeated else {
            return scene;
        };
        // The summary has its own text of the scene: the file of that name may be fine.
        let mut scene = scene.map_err(|error| SceneError {
            file: repeated.summary.clone(),
            origin: error
                .origin
                .filter(|origin| matches!(origin, Origin::Override(_))),
            message: format!("in `scene_as_run`: {}", error.message),
            ..error
        })?;
        if let (Some(then), Some(now)) = (&repeated.data_sha256, &scene.data)
            && *then != now.sha256
        {
            return Err(whole(
                &repeated.summary,
                format!(
                    "{} has changed since that run: its SHA-256 was {then}, and is {}",
                    now.file.display(),
                    now.sha256
                ),
            ));
        }
        let version = env!("CARGO_PKG_VERSION");
        if let Some(then) = repeated.version.as_ref().filter(|then| *then != version) {
            scene.warnings.push(format!(
                "the run that is repeated was of crepitus {then}, and this is {version}: its numbers may differ"
            ));
        }
        Ok(scene)
    }
}

/// The scene of an argument, read: [`Source::find`] and [`Source::scene`].
///
/// # Errors
/// Of either.
pub fn scene(path: &Path, overrides: &Overrides) -> Result<Scene, SceneError> {
    Source::find(path)?.scene(overrides)
}

/// The scene of a simulated device that nobody gives another: `passive-examination`, with an examiner who
/// [chooses the motion](Scene::has_examiner) and moves the leg as he or she likes. The arm of the scene gives way: it
/// is for slow motion.
///
/// # Errors
/// None, as the scene ships.
pub fn examination() -> Result<Scene, SceneError> {
    let mut scene = scene(Path::new("passive-examination"), &Overrides::default())?;
    scene.has_examiner = true;
    (scene.listed).retain(|listed| listed.effect.name != hand::EFFECT.name);
    Ok(scene)
}

/// The most similar name of a scene that ships.
pub fn similar_name(given: &str) -> Option<&'static str> {
    similar(SHIPPED.iter().map(|scene| scene.name), given)
}

/// An error of a whole file.
fn whole(file: &Path, message: impl Into<String>) -> SceneError {
    SceneError {
        file: file.to_owned(),
        origin: None,
        key: String::new(),
        message: message.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MotionKind;

    #[test]
    fn the_examiner_of_a_simulated_device_strokes_a_leg_that_is_held() {
        let plain = scene(Path::new("passive-examination"), &Overrides::default()).unwrap();
        assert!(!plain.has_examiner && plain.has(hand::EFFECT.name));
        let examined = examination().unwrap();
        assert!(examined.has_examiner && examined.is_held());
        assert_eq!(examined.motion_kind, MotionKind::Strokes);
        assert!(!examined.has(hand::EFFECT.name) && examined.has("crepitus"));
    }

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

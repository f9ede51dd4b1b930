//! The presets that ship: the folder `presets`, embedded.

use super::{Preset, Presets};
use crate::similar::similar;
use crepitus_model::Parameters;
use std::path::PathBuf;
use std::sync::LazyLock;

/// A preset's file, embedded.
#[derive(Clone, Copy, Debug)]
pub struct PresetFile {
    /// File name without `.toml`.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! files {
    ($($name:literal)*) => {
        /// All of them by disorder. A preset can build on those above it.
        pub const FILES: &[PresetFile] = &[$(PresetFile {
            name: $name,
            text: include_str!(concat!("../../../../presets/", $name, ".toml")),
        }),*];
    };
}

files! {
    "end-feel-soft" "end-feel-firm" "end-feel-hard" "end-feel-springy" "end-feel-empty"
    "contracture-mild" "contracture-moderate" "contracture-severe" "capsular" "stiff-knee"
    "meniscal-block" "bone-block" "updrs-1-lead-pipe" "updrs-2-lead-pipe" "updrs-3-lead-pipe"
    "updrs-4-lead-pipe" "updrs-1-cogwheel" "updrs-2-cogwheel" "updrs-3-cogwheel" "updrs-4-cogwheel"
    "mas-1-catch" "mas-1plus-catch" "mas-2-catch" "mas-3-catch" "mas-1-reflex" "mas-1plus-reflex"
    "mas-2-reflex" "mas-3-reflex" "mas-4-lead-pipe" "clasp-knife-mild" "clasp-knife-marked"
    "clasp-knife-severe" "scats-1-clonus" "scats-2-clonus" "scats-3-clonus" "texture-fine"
    "texture-coarse" "texture-bone-on-bone" "texture-creaking" "coarse" "fine" "bone-on-bone"
}

impl PresetFile {
    /// Path of the file in the repository.
    pub fn file(&self) -> PathBuf {
        PathBuf::from(format!("presets/{}.toml", self.name))
    }
}

static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let mut presets = Vec::with_capacity(FILES.len());
    for file in FILES {
        let preset = Preset::build_on(Presets::Only(&presets), &file.file(), file.text);
        presets.push(preset.expect("a test reads every preset that ships"));
    }
    presets
});

static JOINTS: LazyLock<Vec<Joint>> = LazyLock::new(|| {
    let alone = |preset: &Preset| preset.listed.is_empty();
    let joints = FILES.iter().zip(PRESETS.iter()).filter(|(_, p)| alone(p));
    joints
        .filter_map(|(file, preset)| {
            Some(Joint {
                name: file.name,
                parameters: preset.crepitus.as_ref()?.settings.parameters,
            })
        })
        .collect()
});

/// All presets that ship, by disorder.
pub fn shipped() -> &'static [Preset] {
    &PRESETS
}

/// The preset of this name that ships.
pub fn find(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The most similar name of a preset that ships.
pub fn similar_name(given: &str) -> Option<&'static str> {
    let names = shipped().iter().map(|preset| preset.name.as_str());
    similar(names, given)
}

/// The stick-slip joint of a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The preset's name.
    pub name: &'static str,
    /// Parameters of the joint.
    pub parameters: Parameters,
}

/// The joints of the presets that are crepitus alone; the paper's is the first.
pub fn joints() -> &'static [Joint] {
    &JOINTS
}

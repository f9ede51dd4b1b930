//! Finding that a student names and that a knee has: a disorder or none, with its level.

use crepitus_scene::preset::{Disorder, Level, Preset};
use serde::{Deserialize, Serialize};

/// A disorder, or a healthy knee.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Finding {
    /// No disorder.
    Healthy,
    /// This disorder.
    Disorder(Disorder),
}

impl Finding {
    /// All: healthy first, then the disorders in the order of [`Disorder::ALL`].
    pub fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Healthy).chain(Disorder::ALL.map(Self::Disorder))
    }

    /// Name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Healthy => HEALTHY,
            Self::Disorder(disorder) => disorder.name(),
        }
    }

    /// The finding of this name.
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|finding| finding.name() == name)
    }
}

/// Name of the knee without a disorder, and of that finding.
pub const HEALTHY: &str = "healthy";

impl From<Finding> for String {
    fn from(finding: Finding) -> Self {
        finding.name().to_owned()
    }
}

impl TryFrom<String> for Finding {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::find(&name).ok_or_else(|| {
            let names: Vec<_> = Self::all().map(Self::name).collect();
            format!(
                "unknown disorder {name:?}: expected one of {}",
                names.join(", ")
            )
        })
    }
}

/// A knee that can be examined: a preset, and the truth about it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Knee {
    /// Name of the preset, or "healthy".
    pub preset: String,
    /// Title of the preset.
    pub title: String,
    /// Disorder; `None` if the preset does not say it, as one's own may.
    pub disorder: Option<Finding>,
    /// Level, if the disorder's grade is one.
    #[serde(with = "level_name")]
    pub level: Option<Level>,
}

impl Knee {
    /// The knee without a disorder.
    pub fn healthy() -> Self {
        Self {
            preset: HEALTHY.to_owned(),
            title: "Healthy knee".to_owned(),
            disorder: Some(Finding::Healthy),
            level: None,
        }
    }
}

impl From<&Preset> for Knee {
    fn from(preset: &Preset) -> Self {
        Self {
            preset: preset.name.clone(),
            title: preset.title.clone().unwrap_or_else(|| preset.name.clone()),
            disorder: preset.disorder.map(Finding::Disorder),
            level: preset.level,
        }
    }
}

/// The level of this name.
pub fn find_level(name: &str) -> Option<Level> {
    Level::ALL.into_iter().find(|level| level.name() == name)
}

/// A level by its name, for serde.
pub mod level_name {
    use super::{Level, find_level};
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes the name, or null.
    ///
    /// # Errors
    /// Of the serializer.
    // The signature is serde's.
    #[allow(clippy::trivially_copy_pass_by_ref, clippy::ref_option)]
    pub fn serialize<S: Serializer>(
        level: &Option<Level>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        level.map(Level::name).serialize(serializer)
    }

    /// Reads a name, or null.
    ///
    /// # Errors
    /// Of the deserializer, and for an unknown name.
    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Level>, D::Error> {
        let Some(name) = Option::<String>::deserialize(deserializer)? else {
            return Ok(None);
        };
        find_level(&name).map(Some).ok_or_else(|| {
            let names = Level::ALL.map(Level::name).join(", ");
            D::Error::custom(format!("unknown level {name:?}: expected one of {names}"))
        })
    }
}

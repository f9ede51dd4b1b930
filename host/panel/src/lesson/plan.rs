//! Plans of lessons.
//!
//! ```toml
//! title = "Six knees, blind"
//! description = "what the lesson is for"
//! instruction = "what to do with every knee, unless a knee has its own"
//! blind = true                     # the students do not see which knee it is; default false
//! curves = false                   # torque curves while the knee is hidden; default false
//! feedback = "each"                # answers are judged after "each" knee or at the "end"
//! repeats = 1                      # how often every knee comes
//!
//! [[knee]]
//! preset = "mas-2-catch"           # or "healthy"
//! instruction = "what to do with this one"
//! target = "fast"                  # a target speed of the panel
//! time_s = 60                      # time for it
//! ```
//!
//! An instruction, target or time of its own is shown with its knee, also in a blind lesson: it must
//! not give the knee away. Only `title` and one `[[knee]]` are required. The page sends the same as JSON, its list named
//! `knees`.

use crepitus_scene::{preset, similar};
use crepitus_studies::experiment::finding::{HEALTHY, Knee};
use serde::{Deserialize, Serialize};

/// Most trials of a lesson.
pub const MOST_TRIALS: usize = 200;

/// Most students of a lesson.
pub const MOST_STUDENTS: usize = 30;

/// Most characters of a title, of every other text, and the longest time of a trial in s.
const MOST_TITLE: usize = 60;
const MOST_TEXT: usize = 500;
const MOST_TIME_S: f64 = 3600.0;

/// A lesson, as a teacher writes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Title, one line.
    pub title: String,
    /// Purpose of the lesson.
    #[serde(default)]
    pub description: String,
    /// Instruction for every knee that has none of its own.
    #[serde(default)]
    pub instruction: Option<String>,
    /// Whether the students do not see which knee it is.
    #[serde(default)]
    pub blind: bool,
    /// Whether the torque curves are shown while the knee is hidden.
    #[serde(default)]
    pub curves: bool,
    /// Time at which answers are judged.
    #[serde(default)]
    pub feedback: Feedback,
    /// Number of times that every knee comes, at least 1.
    #[serde(default = "once")]
    pub repeats: usize,
    /// The knees: `[[knee]]`, or `knees` of the page.
    #[serde(rename = "knee", alias = "knees")]
    pub knees: Vec<PlannedKnee>,
}

const fn once() -> usize {
    1
}

/// A knee of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedKnee {
    /// Name of a preset, or "healthy".
    pub preset: String,
    /// Instruction for this knee.
    #[serde(default)]
    pub instruction: Option<String>,
    /// Name of a target speed.
    #[serde(default)]
    pub target: Option<String>,
    /// Time for it, s.
    #[serde(default)]
    pub time_s: Option<f64>,
}

/// Time at which answers are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feedback {
    /// After each knee.
    #[default]
    Each,
    /// At the end of the lesson.
    End,
}

/// Presets of the user's own and target speeds, which a plan can name besides the shipped presets.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// Finds a preset of the user's own.
    pub own_preset: &'a dyn Fn(&str) -> Option<Knee>,
    /// Whether a target speed of this name exists.
    pub target: &'a dyn Fn(&str) -> bool,
}

/// A plan whose knees all exist.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedPlan {
    plan: Plan,
    knees: Vec<Knee>,
}

/// Error of a plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Text that is not TOML or JSON of a plan; the error's text names the key.
    #[error("the lesson cannot be read: {0}")]
    Form(String),
    /// A text is empty or too long.
    #[error("`{key}` has {characters} characters; expected 1 to {most}: shorten it or fill it in")]
    Text {
        /// The key.
        key: &'static str,
        /// Number of characters of the text.
        characters: usize,
        /// The most.
        most: usize,
    },
    /// There is no such preset.
    #[error(
        "knee {knee}: there is no preset {preset:?}{}; `crepitus presets` lists them, and \"healthy\" is the knee without one",
        .similar.as_ref().map(|name| format!(", did you mean {name:?}")).unwrap_or_default()
    )]
    UnknownPreset {
        /// Knee, from 1.
        knee: usize,
        /// The name.
        preset: String,
        /// The name that is meant, probably.
        similar: Option<String>,
    },
    /// A preset whose disorder nobody knows cannot be guessed.
    #[error(
        "knee {knee}: the preset {preset:?} does not say its disorder, so a blind lesson cannot judge the answers; \
         add `disorder` to its file"
    )]
    NoDisorder {
        /// Knee, from 1.
        knee: usize,
        /// The name.
        preset: String,
    },
    /// There is no such target.
    #[error("knee {knee}: there is no target speed {target:?}; choose one from the panel's list")]
    UnknownTarget {
        /// Knee, from 1.
        knee: usize,
        /// The name.
        target: String,
    },
    /// The time is out of range.
    #[error("knee {knee}: `time_s` is {time_s}; expected more than 0 and at most {MOST_TIME_S} s")]
    Time {
        /// Knee, from 1.
        knee: usize,
        /// The time.
        time_s: f64,
    },
    /// No trials, or too many.
    #[error(
        "{knees} knees, {repeats} times, are not 1 to {MOST_TRIALS} trials: change the list of knees or `repeats`"
    )]
    Trials {
        /// Number of knees.
        knees: usize,
        /// Number of repeats.
        repeats: usize,
    },
}

impl Plan {
    /// Reads TOML.
    ///
    /// # Errors
    /// [`PlanError::Form`] with line, key and expected keys.
    pub fn from_toml(text: &str) -> Result<Self, PlanError> {
        toml::from_str(text).map_err(|error| PlanError::Form(error.to_string()))
    }

    /// Reads JSON, as the page sends it.
    ///
    /// # Errors
    /// [`PlanError::Form`] with the key and the expected keys.
    pub fn from_json(value: serde_json::Value) -> Result<Self, PlanError> {
        serde_json::from_value(value).map_err(|error| PlanError::Form(error.to_string()))
    }

    /// Checks texts and limits, and finds the knees.
    ///
    /// # Errors
    /// [`PlanError`] for the first key that is wrong.
    pub fn check(self, known: Known<'_>) -> Result<CheckedPlan, PlanError> {
        text("title", &self.title, 1, MOST_TITLE)?;
        text("description", &self.description, 0, MOST_TEXT)?;
        let instruction = self.instruction.as_deref().unwrap_or_default();
        text("instruction", instruction, 0, MOST_TEXT)?;
        self.check_trials()?;
        let mut knees = Vec::with_capacity(self.knees.len());
        for (number, planned) in (1..).zip(&self.knees) {
            knees.push(planned.find(number, self.blind, known)?);
        }
        Ok(CheckedPlan { plan: self, knees })
    }

    /// Checks the number of trials.
    fn check_trials(&self) -> Result<(), PlanError> {
        let trials = self.knees.len().checked_mul(self.repeats);
        match trials {
            Some(1..=MOST_TRIALS) => Ok(()),
            _ => Err(PlanError::Trials {
                knees: self.knees.len(),
                repeats: self.repeats,
            }),
        }
    }
}

impl PlannedKnee {
    /// The knee, if all is right about it.
    fn find(&self, knee: usize, blind: bool, known: Known<'_>) -> Result<Knee, PlanError> {
        let instruction = self.instruction.as_deref().unwrap_or_default();
        text("instruction", instruction, 0, MOST_TEXT)?;
        let name = self.preset.as_str();
        let found = match preset::find(name) {
            _ if name == HEALTHY => Some(Knee::healthy()),
            Some(preset) => Some(Knee::from(preset)),
            None => (known.own_preset)(name),
        };
        let Some(found) = found else {
            return Err(PlanError::UnknownPreset {
                knee,
                preset: name.to_owned(),
                similar: similar(name),
            });
        };
        if blind && found.disorder.is_none() {
            let preset = name.to_owned();
            return Err(PlanError::NoDisorder { knee, preset });
        }
        if let Some(target) = &self.target
            && !(known.target)(target)
        {
            let target = target.clone();
            return Err(PlanError::UnknownTarget { knee, target });
        }
        match self.time_s {
            Some(time_s) if !(time_s > 0.0 && time_s <= MOST_TIME_S) => {
                Err(PlanError::Time { knee, time_s })
            }
            _ => Ok(found),
        }
    }
}

impl CheckedPlan {
    /// The plan.
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Knees of the plan, in its order.
    pub fn knees(&self) -> &[Knee] {
        &self.knees
    }

    /// The plan with another number of repeats.
    ///
    /// # Errors
    /// [`PlanError::Trials`] if that is none or too many.
    pub fn repeated(mut self, repeats: usize) -> Result<Self, PlanError> {
        self.plan.repeats = repeats;
        self.plan.check_trials()?;
        Ok(self)
    }

    /// A plan and its knees as they were stored.
    pub(crate) const fn stored(plan: Plan, knees: Vec<Knee>) -> Self {
        Self { plan, knees }
    }
}

/// Checks the length of a text.
fn text(key: &'static str, text: &str, least: usize, most: usize) -> Result<(), PlanError> {
    let characters = text.trim().chars().count();
    if (least..=most).contains(&characters) {
        return Ok(());
    }
    Err(PlanError::Text {
        key,
        characters,
        most,
    })
}

/// A preset whose name begins alike.
fn similar(name: &str) -> Option<String> {
    let shipped = preset::shipped().iter().map(|preset| preset.name.as_str());
    similar::similar(shipped.chain(std::iter::once(HEALTHY)), name).map(str::to_owned)
}

#[cfg(test)]
mod tests;

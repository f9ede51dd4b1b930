//! Protocols of experiments: what is declared before the first participant comes.
//!
//! ```toml
//! title = "Static torque of coarse crepitus"
//! question = "Which of the two was rougher?"
//! consent = "consent.txt"          # beside this file; its SHA-256 is stored with each session
//! seed = 7                         # with the pseudonym it decides the order
//!
//! [threshold]
//! preset = "coarse"                # the knee; "healthy" has none
//! quantity = "crepitus.static_torque_nm"   # a parameter of the device, or "torque"
//! reference = 0.4
//! design = "2ifc"                  # one after the other; "2afc": felt as often as wanted
//!
//! [threshold.constant]             # the method of constant stimuli, or a [threshold.staircase]
//! differences = [0.02, 0.05, 0.1, 0.2]   # comparison less reference
//! repeats = 20                     # trials at each difference
//! catch_trials = 8                 # two references: the answers show a preference
//! ```
//!
//! `torque` is a resistance at the hand, N·m, the same in both directions and at any speed: the device
//! renders it as `lead-pipe.torque_nm`.
//!
//! ```toml
//! [abx]                            # is there a difference that anybody feels?
//! trials = 40
//! a = { preset = "coarse" }
//! b = { preset = "coarse", device = "brace-2", values = { "crepitus.restart" = 1.0 } }
//!
//! [realism]                        # clinicians judge knees
//! presets = ["coarse", "mas-2-catch"]
//! repeats = 2                      # of every knee
//! healthy = 2                      # catch trials: a knee without a disorder
//! features = ["resistance", "end of range"]
//! ```

pub use super::protocol_error::{MOST_TRIALS, ProtocolError};

use super::finding::{HEALTHY, Knee};
use super::protocol_error::number;
use super::staircase::Staircase;
use crepitus_scene::preset::{self, Preset};
use crepitus_scene::values::{check_named, find_of_knee};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most features that are judged.
pub const MOST_FEATURES: usize = 12;

/// Name of the resistance at the hand among the quantities.
pub const TORQUE: &str = "torque";

/// Protocols to begin with: staircases, constant stimuli, A and B, realism.
pub const EXAMPLES: [&str; 4] = [
    include_str!("examples/threshold.toml"),
    include_str!("examples/constant.toml"),
    include_str!("examples/abx.toml"),
    include_str!("examples/realism.toml"),
];

/// An experiment, as it is declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Protocol {
    /// Title, one line.
    pub title: String,
    /// Question that every participant is asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub question: Option<String>,
    /// File with the text to which participants consent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub consent: Option<String>,
    /// Seed of the order.
    #[serde(default)]
    pub seed: u64,
    /// Detection or discrimination of one quantity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threshold: Option<Threshold>,
    /// Comparison of two conditions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub abx: Option<Abx>,
    /// Judgement of knees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub realism: Option<Realism>,
}

/// Measurement of a threshold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Threshold {
    /// The knee in which the quantity varies.
    #[serde(default = "healthy")]
    pub preset: String,
    /// Parameter of a device, or [`TORQUE`].
    pub quantity: String,
    /// Value of the reference.
    #[serde(default)]
    pub reference: f64,
    /// Presentation of the two.
    #[serde(default)]
    pub design: Design,
    /// The method of constant stimuli.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constant: Option<Constant>,
    /// An adaptive method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub staircase: Option<Staircase>,
}

crepitus_model::named! {
    /// Presentation of reference and comparison.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Design {
        /// Two intervals, one after the other, each once.
        #[default]
        #[serde(rename = "2ifc")]
        TwoIntervals => "2ifc",
        /// Two alternatives, each felt as often as the participant wants.
        #[serde(rename = "2afc")]
        TwoAlternatives => "2afc",
    }
}

/// The method of constant stimuli.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// Comparison less reference, in the unit of the quantity; all above 0 or all below.
    pub differences: Vec<f64>,
    /// Trials at each difference.
    pub repeats: usize,
    /// Trials with two references.
    #[serde(default)]
    pub catch_trials: usize,
}

/// Comparison of two conditions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Abx {
    /// Number of trials, even: X is each condition equally often.
    pub trials: usize,
    /// The first condition.
    pub a: Condition,
    /// The second.
    pub b: Condition,
}

/// A knee to render, and the device for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Knee.
    #[serde(default = "healthy")]
    pub preset: String,
    /// Device, by its name; the one of the session if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// Parameters that differ from the knee's.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub values: BTreeMap<String, f64>,
}

/// Judgement of knees by clinicians.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Realism {
    /// The knees.
    pub presets: Vec<String>,
    /// Number of presentations of each.
    #[serde(default = "twice")]
    pub repeats: usize,
    /// Number of trials with a knee without a disorder.
    #[serde(default)]
    pub healthy: usize,
    /// Features that are judged from 1 to 5, besides the whole.
    #[serde(default)]
    pub features: Vec<String>,
}

fn healthy() -> String {
    HEALTHY.to_owned()
}

const fn twice() -> usize {
    2
}

/// Presets that a protocol can name besides those that ship.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// Finds a preset of the user's own.
    pub own_preset: &'a dyn Fn(&str) -> Option<Knee>,
}

impl Known<'_> {
    /// Only presets that ship.
    pub const SHIPPED: Known<'static> = Known {
        own_preset: &|_| None,
    };
}

impl Protocol {
    /// Reads TOML.
    ///
    /// # Errors
    /// [`ProtocolError::Form`] with line, key and expected keys.
    pub fn from_toml(text: &str) -> Result<Self, ProtocolError> {
        toml::from_str(text).map_err(|error| ProtocolError::Form(error.to_string()))
    }

    /// Checks texts, limits, presets and parameters.
    ///
    /// # Errors
    /// [`ProtocolError`] for the first key that is wrong.
    pub fn check(&self, known: Known<'_>) -> Result<(), ProtocolError> {
        text("title", &self.title, 60)?;
        if let Some(question) = &self.question {
            text("question", question, 300)?;
        }
        if self.seed > super::order::MOST_SEED {
            return Err(number(
                "seed",
                self.seed as f64,
                "a whole number below 2^53",
            ));
        }
        let kinds = [
            self.threshold.is_some(),
            self.abx.is_some(),
            self.realism.is_some(),
        ];
        let kinds = kinds.into_iter().filter(|has| *has).count();
        if kinds != 1 {
            return Err(ProtocolError::Kinds(kinds));
        }
        if let Some(threshold) = &self.threshold {
            threshold.check(known)?;
        }
        if let Some(abx) = &self.abx {
            abx.check(known)?;
        }
        self.realism.as_ref().map_or(Ok(()), |r| r.check(known))
    }
}

impl Threshold {
    fn check(&self, known: Known<'_>) -> Result<(), ProtocolError> {
        known.find(&self.preset)?;
        let largest = match (&self.constant, &self.staircase) {
            (Some(constant), None) => constant.check()?,
            (None, Some(staircase)) => {
                staircase.check()?;
                trials(staircase.trials * staircase.interleaved)?;
                staircase.range()
            }
            (one, other) => {
                let methods = usize::from(one.is_some()) + usize::from(other.is_some());
                return Err(ProtocolError::Methods(methods));
            }
        };
        let is_finite = self.reference.is_finite();
        if !is_finite {
            return Err(number("reference", self.reference, "a finite number"));
        }
        for difference in [0.0, largest[0], largest[1]] {
            let values = values_of(&self.quantity, self.reference + difference);
            check_values(
                &self.preset,
                values.iter().map(|(name, x)| (name.as_str(), *x)),
            )?;
        }
        Ok(())
    }
}

impl Constant {
    /// Least and largest difference.
    fn check(&self) -> Result<[f64; 2], ProtocolError> {
        let all = self.differences.iter().copied();
        let (least, most) = all.clone().fold((f64::MAX, f64::MIN), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let bad = all.clone().find(|x| !x.is_finite() || *x == 0.0);
        let mixed = (least < 0.0 && most > 0.0).then_some(least);
        if let Some(bad) = bad.or(mixed) {
            let expected = "finite numbers, all above 0 or all below";
            return Err(number("differences", bad, expected));
        }
        let mut sorted: Vec<f64> = all.collect();
        sorted.sort_by(f64::total_cmp);
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let entry = pair[0].to_string();
            return Err(ProtocolError::Twice {
                key: "differences",
                entry,
            });
        }
        let of_levels = self.differences.len().saturating_mul(self.repeats);
        if of_levels == 0 {
            return Err(ProtocolError::Trials(0));
        }
        trials(of_levels.saturating_add(self.catch_trials))?;
        Ok([least, most])
    }
}

impl Abx {
    fn check(&self, known: Known<'_>) -> Result<(), ProtocolError> {
        trials(self.trials)?;
        if self.trials % 2 == 1 {
            let expected = "an even number: X is each condition equally often";
            return Err(number("trials", self.trials as f64, expected));
        }
        for condition in [&self.a, &self.b] {
            known.find(&condition.preset)?;
            let values = condition.values.iter();
            check_values(
                &condition.preset,
                values.map(|(name, x)| (name.as_str(), *x)),
            )?;
        }
        if self.a == self.b {
            let entry = self.a.preset.clone();
            return Err(ProtocolError::Twice { key: "a, b", entry });
        }
        Ok(())
    }
}

impl Realism {
    fn check(&self, known: Known<'_>) -> Result<(), ProtocolError> {
        for preset in &self.presets {
            if known.find(preset)?.disorder.is_none() {
                return Err(ProtocolError::NoDisorder(preset.clone()));
            }
        }
        twice_in("presets", &self.presets)?;
        twice_in("features", &self.features)?;
        if self.features.len() > MOST_FEATURES {
            let count = self.features.len() as f64;
            return Err(number("features", count, "up to 12 of them"));
        }
        for feature in &self.features {
            text("features", feature, 40)?;
        }
        let knees = self.presets.len().saturating_mul(self.repeats);
        if knees == 0 {
            return Err(ProtocolError::Trials(0));
        }
        trials(knees.saturating_add(self.healthy))
    }
}

impl Known<'_> {
    /// The knee of this name.
    ///
    /// # Errors
    /// [`ProtocolError::UnknownPreset`].
    pub fn find(&self, name: &str) -> Result<Knee, ProtocolError> {
        if name == HEALTHY {
            return Ok(Knee::healthy());
        }
        if let Some(preset) = preset::find(name) {
            return Ok(Knee::from(preset));
        }
        (self.own_preset)(name).ok_or_else(|| ProtocolError::UnknownPreset {
            preset: name.to_owned(),
            similar: preset::similar_name(name).map(str::to_owned),
        })
    }
}

/// Checks parameters of a knee; of a preset that does not ship each by itself.
fn check_values<'n>(
    preset: &str,
    values: impl Iterator<Item = (&'n str, f64)>,
) -> Result<(), ProtocolError> {
    let none = Preset::default();
    let knee = preset::find(preset).or_else(|| (preset == HEALTHY).then_some(&none));
    match knee {
        Some(knee) => check_named(knee, values)?,
        None => values
            .into_iter()
            .try_for_each(|(name, x)| find_of_knee(name, x).map(drop))?,
    }
    Ok(())
}

/// The two parameters that render a value of a quantity: the switch of its effect, and the number.
pub(super) fn values_of(quantity: &str, value: f64) -> [(String, f64); 2] {
    let parameter = if quantity == TORQUE {
        "lead-pipe.torque_nm"
    } else {
        quantity
    };
    let (group, _) = parameter.split_once('.').unwrap_or((parameter, ""));
    [
        (format!("{group}.render"), 1.0),
        (parameter.to_owned(), value),
    ]
}

fn trials(count: usize) -> Result<(), ProtocolError> {
    match count {
        1..=MOST_TRIALS => Ok(()),
        _ => Err(ProtocolError::Trials(count)),
    }
}

fn text(key: &'static str, text: &str, most: usize) -> Result<(), ProtocolError> {
    let characters = text.trim().chars().count();
    if (1..=most).contains(&characters) {
        return Ok(());
    }
    Err(ProtocolError::Text {
        key,
        characters,
        most,
    })
}

fn twice_in(key: &'static str, list: &[String]) -> Result<(), ProtocolError> {
    let repeated = |(place, entry): (usize, &String)| {
        let before = list.get(..place).unwrap_or_default();
        before.contains(entry).then(|| entry.clone())
    };
    match list.iter().enumerate().find_map(repeated) {
        Some(entry) => Err(ProtocolError::Twice { key, entry }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;

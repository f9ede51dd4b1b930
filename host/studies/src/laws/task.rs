//! A task: something that a device has to render, with numbers that are known.

use super::runner::Runner;
use crate::watcher::StudyError;
use crepitus_model::SettingsError;
use crepitus_scene::preset::Joint;
use serde::Serialize;

/// Use of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Use {
    /// A joint that grates as it is moved.
    Grating,
    /// A joint that is held under a load, and moved a little about it.
    Rest,
    /// A joint that is moved to and fro: breaking away, turning back.
    Moving,
    /// A leg with a hand on it, coupled to the device.
    Coupled,
    /// Running for long, and being adjusted while it runs.
    Running,
}

impl Use {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Grating,
        Self::Rest,
        Self::Moving,
        Self::Coupled,
        Self::Running,
    ];

    /// The use, as it follows "for".
    pub fn title(self) -> &'static str {
        match self {
            Self::Grating => "a joint that grates",
            Self::Rest => "rest and creep",
            Self::Moving => "breaking away and turning back",
            Self::Coupled => "a leg with a hand on it",
            Self::Running => "running for long, and changes while running",
        }
    }
}

/// A number that a task measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name in tables: `grating-frequency`.
    pub name: &'static str,
    /// Description.
    pub title: &'static str,
    /// Unit; `1` if it has none.
    pub unit: &'static str,
    /// One sentence: what is demanded, and how it is known.
    pub demands: &'static str,
    /// Use that it is needed for.
    pub of: Use,
}

/// The known value of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Value.
    pub value: f64,
    /// Size of an error that is as large as the effect: relative errors are errors over it.
    pub scale: f64,
    /// More than the value is no error.
    pub is_at_least: bool,
}

impl Demand {
    /// A value whose errors are seen beside itself.
    pub fn itself(value: f64) -> Self {
        Self::beside(value, value)
    }

    /// A value whose errors are seen beside `scale`.
    pub fn beside(value: f64, scale: f64) -> Self {
        Self {
            value,
            scale,
            is_at_least: false,
        }
    }

    /// A value that is the least, with errors seen beside itself.
    pub fn at_least(value: f64) -> Self {
        Self {
            is_at_least: true,
            ..Self::itself(value)
        }
    }

    /// Error of a value.
    pub fn error(&self, value: f64) -> f64 {
        let error = value - self.value;
        if self.is_at_least {
            error.min(0.0)
        } else {
            error
        }
    }

    /// Zero, with errors seen beside `scale`.
    pub fn none_of(scale: f64) -> Self {
        Self::beside(0.0, scale)
    }
}

/// Reading of a quantity from a law. Never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Value, if there is one.
    pub value: Option<f64>,
    /// Reason why the law cannot do it.
    pub failed: Option<&'static str>,
}

impl Reading {
    /// A value; without one if it is not finite.
    pub fn of(value: f64) -> Self {
        if value.is_finite() {
            Self {
                value: Some(value),
                failed: None,
            }
        } else {
            Self::failed("its number is not finite")
        }
    }

    /// A value, and `reason` if the law does not do what it is measured at.
    pub fn but(value: f64, is_failed: bool, reason: &'static str) -> Self {
        Self {
            failed: is_failed.then_some(reason),
            ..Self::of(value)
        }
    }

    /// No value.
    pub fn failed(reason: &'static str) -> Self {
        Self {
            value: None,
            failed: Some(reason),
        }
    }
}

/// Extent of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// A few seconds.
    Quick,
    /// A few minutes.
    Full,
    /// With a day in f32.
    Long,
}

/// Setting that a task is prepared for.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The joint that every law is fitted to.
    pub joint: Joint,
    /// Extent of the study.
    pub extent: Extent,
}

impl Setting {
    /// `full`, or `quick` in a quick study.
    pub fn or_quick<T>(&self, full: T, quick: T) -> T {
        if self.extent == Extent::Quick {
            quick
        } else {
            full
        }
    }
}

/// A task. Its file says how its known numbers are derived, and tests them on our joint.
pub trait Task: Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;

    /// Title: the task in a few words.
    fn title(&self) -> &'static str;

    /// Quantities that are measured.
    fn quantities(&self) -> &'static [Quantity];

    /// Returns whether one joint is enough, as it takes long and the joint hardly matters.
    fn is_for_one_joint(&self) -> bool {
        false
    }

    /// Computes what all laws share.
    ///
    /// # Errors
    /// [`StudyError`] if the joint is invalid.
    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError>;
}

/// A task on one joint.
pub trait Prepared: Send + Sync {
    /// The known numbers, in the order of the quantities.
    fn demanded(&self) -> Vec<Demand>;

    /// Numbers of steps in a tick, ascending, at which the law converges: the last two tell how far it
    /// has.
    fn refinements(&self) -> &[u32] {
        &[8, 32]
    }

    /// Measures a law, in the order of the quantities.
    ///
    /// # Errors
    /// [`SettingsError`] if joint or step are invalid for the law.
    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError>;
}

//! A row of a study of effects: the scene or one of its variants, and its outcome.

use super::influence::Torque;
use super::variant::Change;
use crepitus_scene::run::AddedTime;

/// The scene or one of its variants.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Kind of change to the scene.
    pub change: Change,
    /// The effect; empty for the scene itself.
    pub effect: &'static str,
    /// Effects dropped or added with it.
    pub along: Vec<&'static str>,
    /// State variables.
    pub states: usize,
    /// CPU time of a step without outputs, ns, on the machine of the study.
    pub ns_per_step: f64,
    /// Relative excess of the first quartile of the timings over the fastest.
    pub time_spread: f64,
    /// Instructions of a step without outputs; NaN where nothing was counted.
    pub instructions_per_step: f64,
    /// Outcome of the run.
    pub outcome: Outcome,
}

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The run was completed.
    Ran(Ran),
    /// The run failed.
    Failed {
        /// Reason why the run failed.
        failure: String,
    },
}

/// A completed run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ran {
    /// Torque at the hand.
    pub torque: Torque,
    /// Events of the joint and of the other symptoms.
    pub events: u64,
    /// Contribution of the effect and of those dropped or added with it; `None`
    /// for the scene itself.
    pub added: Option<Added>,
}

/// Contribution of an effect: with it minus without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Added {
    /// Root mean square of the torque that it adds at the hand, N·m.
    pub rms_nm: f64,
    /// Largest magnitude of that, N·m.
    pub peak_nm: f64,
    /// Events.
    pub events: i64,
    /// State variables.
    pub states: i64,
    /// CPU time of a step. Below the resolution of the timings only the bound
    /// is known: the effect saves as much work as it makes, or it is within
    /// the noise.
    pub time: AddedTime,
    /// Instructions of a step; NaN where nothing was counted.
    pub instructions: f64,
}

impl Row {
    /// The completed run, if it did not fail.
    pub fn ran(&self) -> Option<&Ran> {
        match &self.outcome {
            Outcome::Ran(ran) => Some(ran),
            Outcome::Failed { .. } => None,
        }
    }

    /// Contribution of the effect, if both runs were completed.
    pub fn added(&self) -> Option<&Added> {
        self.ran().and_then(|ran| ran.added.as_ref())
    }

    /// Reason why the run failed.
    pub fn failure(&self) -> Option<&str> {
        match &self.outcome {
            Outcome::Ran(_) => None,
            Outcome::Failed { failure } => Some(failure),
        }
    }

    /// Description, such as `without drivetrain (and backlash)`.
    pub fn name(&self) -> String {
        match (self.change, self.along.as_slice()) {
            (Change::Scene, _) => "the scene".to_owned(),
            (change, []) => format!("{} {}", change.name(), self.effect),
            (change, along) => format!(
                "{} {} (and {})",
                change.name(),
                self.effect,
                along.join(", ")
            ),
        }
    }
}

//! What a study of effects found.

use super::answer::Answer;
use super::build_up::Rung;
use super::build_up::RungTorques;
use super::influence::Torque;
use super::variant::Change;
use super::window::HandTorque;
use crepitus_scene::run::AddedTime;
use serde::Serialize;

/// A study's results.
#[derive(Clone, Debug, Serialize)]
pub struct EffectsStudy {
    /// The scene's file.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Its effects.
    pub effects: Vec<&'static str>,
    /// Length of a tick, s.
    pub tick_s: f64,
    /// How many there were.
    pub ticks: u64,
    /// What was odd about the scene.
    pub warnings: Vec<String>,
    /// The scene, then its variants.
    pub rows: Vec<Row>,
    /// Timings of which the fastest counts.
    pub timings: u32,
    /// The smallest set of effects, if a tolerance was asked for.
    pub answer: Option<Answer>,
    /// The scene's effects one after the other; nothing without a joint or a
    /// plant.
    pub build_up: Vec<Rung>,
    /// How long the study took, s.
    pub wall_s: f64,
    /// The torques of that.
    #[serde(skip)]
    pub build_up_torques: Vec<RungTorques>,
    /// The torque at the hand in a telling window: of the scene, and of the
    /// variants that differ most.
    #[serde(skip)]
    pub hand_torque: Option<HandTorque>,
}

/// The scene or one of its variants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What was done to the scene.
    pub change: Change,
    /// With which effect; empty for the scene itself.
    pub effect: &'static str,
    /// What left or came with it.
    pub along: Vec<&'static str>,
    /// State variables.
    pub states: usize,
    /// CPU time of a step without outputs, ns, on the machine of the study.
    pub ns_per_step: f64,
    /// How much longer than the fastest timing the fastest quarter of them took
    /// at most, as a share.
    pub time_spread: f64,
    /// What came of it.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// What came of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// It ran.
    Ran(Ran),
    /// It did not.
    Failed {
        /// Why.
        failure: String,
    },
}

/// A run to its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ran {
    /// What the hand felt.
    pub torque: Torque,
    /// Events of the joint.
    pub events: u64,
    /// What the effect, and what came or left with it, adds; nothing for the
    /// scene itself.
    pub added: Option<Added>,
}

/// What an effect adds: with it less without it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Added {
    /// Root mean square of the torque that it adds at the hand, N·m.
    pub rms_nm: f64,
    /// Largest magnitude of that, N·m.
    pub peak_nm: f64,
    /// Events.
    pub events: i64,
    /// State variables.
    pub states: i64,
    /// CPU time of a step. Where a run is not longer with it than the timings
    /// can tell only the bound is known: the effect spares as much work as it
    /// makes, or it hides in the noise.
    #[serde(flatten)]
    pub time: AddedTime,
}

impl Row {
    /// What came of the run, if it ran.
    pub fn ran(&self) -> Option<&Ran> {
        match &self.outcome {
            Outcome::Ran(ran) => Some(ran),
            Outcome::Failed { .. } => None,
        }
    }

    /// What the effect adds, if both ran.
    pub fn added(&self) -> Option<&Added> {
        self.ran().and_then(|ran| ran.added.as_ref())
    }

    /// Why it did not run.
    pub fn failure(&self) -> Option<&str> {
        match &self.outcome {
            Outcome::Ran(_) => None,
            Outcome::Failed { failure } => Some(failure),
        }
    }

    /// What it is: `without drivetrain (and backlash)`.
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

impl EffectsStudy {
    /// The scene's own row.
    pub fn whole(&self) -> Option<&Row> {
        self.rows.first()
    }

    /// The median spread of the timings, as a share: a cost below this much of
    /// a step may be none.
    pub fn time_spread(&self) -> f64 {
        let mut spreads: Vec<f64> = self.rows.iter().map(|row| row.time_spread).collect();
        spreads.retain(|spread| spread.is_finite());
        spreads.sort_by(f64::total_cmp);
        spreads.get(spreads.len() / 2).copied().unwrap_or(0.0)
    }

    /// The variants that ran, by what the effect adds to the torque, the most
    /// first.
    pub fn by_influence(&self) -> Vec<&Row> {
        let mut rows: Vec<&Row> = self.rows.iter().filter(|r| r.added().is_some()).collect();
        let rms = |row: &Row| row.added().map_or(0.0, |a| a.rms_nm);
        rows.sort_by(|a, b| rms(b).total_cmp(&rms(a)));
        rows
    }
}

//! Results of a study of effects.

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
    /// Number of ticks.
    pub ticks: u64,
    /// Warnings of the scene's run.
    pub warnings: Vec<String>,
    /// The scene, then its variants.
    #[serde(serialize_with = "super::effects_table::serialize")]
    pub rows: Vec<Row>,
    /// Number of timings, of which the fastest counts.
    pub timings: u32,
    /// The smallest set of effects, if a tolerance was given.
    pub answer: Option<Answer>,
    /// The scene's effects added one by one; empty without a joint or a plant.
    pub build_up: Vec<Rung>,
    /// Duration of the study, s.
    pub wall_s: f64,
    /// The torques of `build_up`.
    #[serde(skip)]
    pub build_up_torques: Vec<RungTorques>,
    /// The torque at the hand in the window of largest differences: of the
    /// scene, and of the variants that differ most.
    #[serde(skip)]
    pub hand_torque: Option<HandTorque>,
}

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
    /// Its outcome.
    pub outcome: Outcome,
}

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It was completed.
    Ran(Ran),
    /// It failed.
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

impl EffectsStudy {
    /// The scene's own row.
    pub fn whole(&self) -> Option<&Row> {
        self.rows.first()
    }

    /// The median relative spread of the timings: costs below this share of a
    /// step are not significant.
    pub fn time_spread(&self) -> f64 {
        let mut spreads: Vec<f64> = self.rows.iter().map(|row| row.time_spread).collect();
        spreads.retain(|spread| spread.is_finite());
        spreads.sort_by(f64::total_cmp);
        spreads.get(spreads.len() / 2).copied().unwrap_or(0.0)
    }

    /// The completed variants by how much of the [vibration](Torque::vibration_nm) at the hand they change, most
    /// first. The weight of a leg, which is felt but tells nothing of a knee, does not count.
    pub fn by_vibration(&self) -> Vec<(&Row, f64)> {
        let vibration = |row: &Row| row.ran().map_or(f64::NAN, |ran| ran.torque.vibration_nm());
        let scene = self.whole().map_or(f64::NAN, vibration);
        let variants = self.rows.iter().filter(|row| row.added().is_some());
        let mut rows: Vec<(&Row, f64)> =
            variants.map(|row| (row, vibration(row) - scene)).collect();
        rows.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        rows
    }
}

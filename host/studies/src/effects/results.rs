//! Results of a study of effects.

use super::answer::Answer;
use super::build_up::Rung;
use super::build_up::RungTorques;
use super::row::Row;
use super::window::HandTorque;
use serde::Serialize;

/// A study's results.
#[derive(Clone, Debug, Serialize)]
pub struct EffectsStudy {
    /// The scene's file.
    pub scene: String,
    /// Title of the scene.
    pub title: String,
    /// Effects of the scene.
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
    /// Instructions of a step of the motion alone, without any effect: what there is around them
    /// all. NaN where nothing was counted.
    pub loop_instructions: f64,
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

    /// The completed variants by how much of the [vibration](super::influence::Torque::vibration_nm) at the hand they change, most
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

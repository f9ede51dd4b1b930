//! Events of a symptom, and their matching.

use crate::matching::{Alike, Matching, match_alike};
use crepitus_model::render::effects::symptom::Word;

/// Event of a symptom, with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymptomEvent {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// Kind of event.
    pub word: Word,
    /// Velocity of the joint, rad/s.
    pub omega_rad_s: f64,
    /// Torque just before, N·m.
    pub before_nm: f64,
    /// Torque just after, N·m.
    pub after_nm: f64,
}

impl Alike for SymptomEvent {
    fn time_s(&self) -> f64 {
        self.time_s
    }

    fn is_like(&self, other: &Self) -> bool {
        self.word == other.word
    }
}

/// Matches events of a run in steps of `step_s` that ends at `end_s`.
pub fn matched(
    truth: &[SymptomEvent],
    found: &[SymptomEvent],
    step_s: f64,
    end_s: f64,
) -> Matching {
    match_alike(truth, found, end_s - 2.0 * step_s)
}

/// A joint is at rest below this, rad/s.
const REST_RAD_S: f64 = 1e-9;

/// A torque that changes by less does not, N·m.
const SAME_NM: f64 = 1e-9;

impl SymptomEvent {
    /// Returns whether a tooth passes a joint at rest without any change: rounding decides
    /// whether that is an event.
    fn is_silent(&self) -> bool {
        matches!(self.word, Word::Give | Word::Catch)
            && self.omega_rad_s.abs() < REST_RAD_S
            && (self.after_nm - self.before_nm).abs() < SAME_NM
    }
}

/// Events of the symptom itself, without those of the play under it and without what
/// nobody can feel.
pub fn own(events: impl IntoIterator<Item = SymptomEvent>) -> Vec<SymptomEvent> {
    events
        .into_iter()
        .filter(|event| !event.word.is_of_play() && !event.is_silent())
        .collect()
}

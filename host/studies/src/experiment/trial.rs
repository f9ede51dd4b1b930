//! A trial: its stimuli for the device, the answer of a participant, and its line in the table.

use super::finding::{Finding, HEALTHY};
use std::collections::BTreeMap;

/// Knee of one interval, for the device. Whoever sees it is not blind.
#[derive(Clone, Debug, PartialEq)]
pub struct Stimulus {
    /// Knee.
    pub preset: String,
    /// Device, by its name; the one of the session if there is none.
    pub device: Option<String>,
    /// Parameters that differ from the knee's.
    pub values: BTreeMap<String, f64>,
}

impl Stimulus {
    /// A knee as it is.
    pub(super) fn of(preset: &str) -> Self {
        Self {
            preset: preset.to_owned(),
            device: None,
            values: BTreeMap::new(),
        }
    }

    /// Returns whether there is no disorder and no value.
    pub fn is_healthy(&self) -> bool {
        self.preset == HEALTHY && self.values.is_empty()
    }
}

/// Trial that is presented next.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Number, from 1.
    pub number: usize,
    /// Number of all trials; the most of staircases.
    pub of: usize,
    /// Intervals, in the order in which they are presented.
    pub intervals: Vec<Stimulus>,
}

/// Answer of a participant.
#[derive(Clone, Debug, PartialEq)]
pub enum Response {
    /// An alternative, from 1: of a threshold the interval that has more; of A, B and X, 1 if X is A.
    Choice(u8),
    /// Description in one's own words; before a rating.
    Description(String),
    /// The rating of a knee that was described.
    Rating(Rating),
}

/// Judgement of a knee.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rating {
    /// Realism, 1 to 5, of the whole and of each feature.
    pub realism: Vec<u8>,
    /// Severity: 0 none, 1 mild, 2 moderate, 3 severe.
    pub severity: u8,
    /// Type.
    pub finding: Finding,
}

/// A line of the table.
#[derive(Clone, Debug, PartialEq)]
pub enum Row {
    /// Of a threshold.
    Threshold(ThresholdRow),
    /// Of A, B and X.
    Abx(AbxRow),
    /// Of a realism session.
    Realism(RealismRow),
}

/// A trial of a threshold.
#[derive(Clone, Debug, PartialEq)]
pub struct ThresholdRow {
    /// Number, from 1.
    pub trial: usize,
    /// Staircase, from 1; 0 under constant stimuli.
    pub staircase: usize,
    /// Comparison less reference; 0 in a catch trial.
    pub difference: f64,
    /// Interval of the comparison, from 1.
    pub comparison_in: u8,
    /// Interval that was chosen.
    pub answer: u8,
    /// Whether that is the one that has more; in a catch trial whether it is the comparison's.
    pub is_right: bool,
    /// Whether the staircase turned.
    pub has_turned: bool,
    /// Time of the answer, s since 1970.
    pub unix_s: f64,
}

/// A trial of A, B and X.
#[derive(Clone, Debug, PartialEq)]
pub struct AbxRow {
    /// Number, from 1.
    pub trial: usize,
    /// The condition that X is: 1 A, 2 B.
    pub x: u8,
    /// The condition that was chosen.
    pub answer: u8,
    /// Time of the answer, s since 1970.
    pub unix_s: f64,
}

/// A trial of a realism session.
#[derive(Clone, Debug, PartialEq)]
pub struct RealismRow {
    /// Number, from 1.
    pub trial: usize,
    /// Preset, or "healthy".
    pub knee: String,
    /// Presentation of this knee, from 1.
    pub presentation: usize,
    /// Description.
    pub description: String,
    /// The judgement.
    pub rating: Rating,
    /// Time of the answer, s since 1970.
    pub unix_s: f64,
}

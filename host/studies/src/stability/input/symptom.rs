//! Input of symptoms other than crepitus, as the device renders them.

use crate::stability::text::Time;
use crate::symptoms::{Given, Hand};
use std::fmt;

/// Symptoms under a hand.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SymptomRun {
    pub(crate) symptoms: Vec<Given>,
    pub(crate) hand: Hand,
    /// Whether they get counts of the device's encoder, or the true motion.
    pub(crate) counts: bool,
    /// Commits: when, s, and what is rendered from then on.
    pub(crate) commits: Vec<(f64, Vec<Given>)>,
    /// Ticks that the torque is late, where energy is measured.
    pub(crate) delay_ticks: usize,
    /// Whether it is late by any number of ticks up to that.
    pub(crate) delay_varies: bool,
}

impl SymptomRun {
    /// Returns whether the reference solves it too: one symptom, on the true motion, as it
    /// was armed.
    pub(crate) fn suits_the_reference(&self) -> bool {
        self.symptoms.len() == 1 && !self.counts && self.commits.is_empty()
    }
}

fn list(symptoms: &[Given]) -> String {
    let symptoms: Vec<_> = symptoms.iter().map(ToString::to_string).collect();
    symptoms.join(" and ")
}

impl fmt::Display for SymptomRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", list(&self.symptoms), self.hand)?;
        if self.counts {
            f.write_str(", seen through the encoder")?;
        }
        if self.delay_ticks > 0 {
            let least = if self.delay_varies { "0 to " } else { "" };
            write!(f, ", the torque {least}{} ticks late", self.delay_ticks)?;
        }
        for (at_s, symptoms) in &self.commits {
            write!(f, ", from {} on {}", Time(*at_s), list(symptoms))?;
        }
        Ok(())
    }
}

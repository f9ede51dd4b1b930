//! Input of symptoms other than crepitus, as the device renders them.

use super::Lost;
use crate::stability::text::Time;
use crate::symptoms::{Given, Hand};
use std::fmt;

/// Symptoms under a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct SymptomRun {
    /// The symptoms.
    pub symptoms: Vec<Given>,
    /// Motion of the hand.
    pub hand: Hand,
    /// Whether they get counts of the device's encoder, or the true motion.
    pub counts: bool,
    /// Commits: when, s, and what is rendered from then on.
    pub commits: Vec<(f64, Vec<Given>)>,
    /// Lost samples.
    pub lost: Lost,
    /// Ticks that the torque is late, where energy is measured.
    pub delay_ticks: usize,
    /// Whether it is late by any number of ticks up to that.
    pub delay_varies: bool,
    /// Duration, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

/// Symptoms that must be refused.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedSymptoms {
    /// The mistake.
    pub what: &'static str,
    /// The symptoms.
    pub symptoms: Vec<Given>,
}

impl SymptomRun {
    /// Returns whether the reference solves it too: one symptom, on the true motion, as it
    /// was armed.
    pub(in crate::stability) fn suits_the_reference(&self) -> bool {
        self.symptoms.len() == 1
            && !self.counts
            && self.commits.is_empty()
            && self.lost == Lost::NONE
    }
}

fn list(f: &mut fmt::Formatter<'_>, symptoms: &[Given]) -> fmt::Result {
    for (i, given) in symptoms.iter().enumerate() {
        let and = if i == 0 { "" } else { " and " };
        write!(f, "{and}{given}")?;
    }
    Ok(())
}

impl fmt::Display for SymptomRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        list(f, &self.symptoms)?;
        write!(f, ": {}", self.hand)?;
        if self.counts {
            f.write_str(", seen through the encoder")?;
        }
        if self.delay_ticks > 0 {
            let least = if self.delay_varies { "0 to " } else { "" };
            write!(f, ", the torque {least}{} ticks late", self.delay_ticks)?;
        }
        if self.lost.ticks > 0 {
            write!(
                f,
                ", {} samples in a row lost of every {}",
                self.lost.ticks, self.lost.every
            )?;
        }
        for (at_s, symptoms) in &self.commits {
            write!(f, ", from {} on ", Time(*at_s))?;
            list(f, symptoms)?;
        }
        Ok(())
    }
}

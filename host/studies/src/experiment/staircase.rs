//! Staircases: the next level follows from the last answers.
//!
//! ```toml
//! [threshold.staircase]
//! rule = "1-up-2-down"     # or "1-up-3-down", "1-up-4-down", "weighted"
//! start = 0.2              # difference of the first trial
//! steps = [0.04, 0.02]     # down, after 0, 1, … reversals; the last one stays
//! scale = "linear"         # "log": steps are decades
//! least = 0.005            # limits of the difference
//! most = 0.4
//! reversals = 12           # then it ends
//! trials = 80              # then at the latest
//! interleaved = 2          # staircases at once, in a random order
//! target = 0.75            # of "weighted"
//! ```
//!
//! - **1-up-n-down**: n right answers in a row, and the level goes down; a wrong one, and it goes up by the same step.
//!   It converges where n in a row are as likely as not, p = 0.5^(1/n): 70.7 % for 2, 79.4 % for 3 (Levitt,
//!   *Transformed up-down methods in psychoacoustics*, JASA 49, 1971).
//! - **weighted**: down after every right answer, up after every wrong one by the step times p/(1 − p), which
//!   balances at p (Kaernbach, *Simple adaptive testing with the weighted up-down method*, Perception &
//!   Psychophysics 49, 1991).
//!
//! A reversal is a trial at which the direction turns. At a limit the level stays, and turns nothing.

use super::protocol_error::{MOST_TRIALS, ProtocolError, number};
use serde::{Deserialize, Serialize};

/// An adaptive method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Staircase {
    /// Rule of the steps.
    pub rule: Rule,
    /// Difference of the first trial.
    pub start: f64,
    /// Steps down after 0, 1, … reversals; the last one stays.
    pub steps: Vec<f64>,
    /// Scale of the steps.
    #[serde(default)]
    pub scale: Scale,
    /// Least difference.
    pub least: f64,
    /// Largest difference.
    pub most: f64,
    /// Reversals at which it ends.
    pub reversals: usize,
    /// Trials at which it ends at the latest.
    pub trials: usize,
    /// Staircases that run at once.
    #[serde(default = "one")]
    pub interleaved: usize,
    /// Share of right answers to which `weighted` converges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<f64>,
}

const fn one() -> usize {
    1
}

crepitus_model::named! {
    /// Rule of the steps.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Rule {
        /// Two right answers.
        #[serde(rename = "1-up-2-down")]
        TwoDown => "1-up-2-down",
        /// Three right answers.
        #[serde(rename = "1-up-3-down")]
        ThreeDown => "1-up-3-down",
        /// Four right answers.
        #[serde(rename = "1-up-4-down")]
        FourDown => "1-up-4-down",
        /// Unequal steps.
        #[serde(rename = "weighted")]
        Weighted => "weighted",
    }
}

impl Rule {
    /// Right answers in a row before the level goes down.
    const fn needed(self) -> u32 {
        match self {
            Self::TwoDown => 2,
            Self::ThreeDown => 3,
            Self::FourDown => 4,
            Self::Weighted => 1,
        }
    }
}

crepitus_model::named! {
    /// Scale of the steps.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Scale {
        /// Steps are differences, in the unit of the quantity.
        #[default]
        Linear => "linear",
        /// Steps are decades of the difference.
        Log => "log",
    }
}

impl Staircase {
    /// Checks the numbers.
    pub(super) fn check(&self) -> Result<(), ProtocolError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let is_step = |x: &&f64| !positive(**x);
        if self.steps.is_empty() {
            return Err(number("steps", 0.0, "one step or more"));
        }
        if let Some(step) = self.steps.iter().find(is_step) {
            return Err(number("steps", *step, "numbers above 0"));
        }
        for (key, value) in [("least", self.least), ("most", self.most)] {
            if !positive(value) {
                return Err(number(key, value, "a number above 0"));
            }
        }
        if !(self.least <= self.start && self.start <= self.most) {
            return Err(number(
                "start",
                self.start,
                "a number from `least` to `most`",
            ));
        }
        match (self.rule, self.target) {
            (Rule::Weighted, Some(p)) if p > 0.5 && p < 1.0 => {}
            (Rule::Weighted, p) => {
                let expected = "a share above 0.5, below 1, as the rule is \"weighted\"";
                return Err(number("target", p.unwrap_or(f64::NAN), expected));
            }
            (_, Some(p)) => return Err(number("target", p, "nothing: the rule decides it")),
            _ => {}
        }
        for (key, count) in [
            ("reversals", self.reversals),
            ("trials", self.trials),
            ("interleaved", self.interleaved),
        ] {
            if !(1..=MOST_TRIALS).contains(&count) {
                return Err(number(key, count as f64, "a number from 1 to 2000"));
            }
        }
        Ok(())
    }

    /// Least and largest difference.
    pub(super) const fn range(&self) -> [f64; 2] {
        [self.least, self.most]
    }

    /// Share of right answers to which it converges.
    pub fn target(&self) -> f64 {
        match self.rule {
            Rule::Weighted => self.target.unwrap_or(f64::NAN),
            rule => 0.5_f64.powf(1.0 / f64::from(rule.needed())),
        }
    }
}

/// One staircase under way.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track {
    /// Difference of the next trial.
    pub(super) level: f64,
    /// Levels of its reversals.
    pub(super) reversals: Vec<f64>,
    /// Trials so far.
    trials: usize,
    /// Right answers in a row.
    right: u32,
    /// Whether the last step went up.
    was_up: Option<bool>,
}

impl Track {
    pub(super) const fn new(plan: &Staircase) -> Self {
        Self {
            level: plan.start,
            reversals: Vec::new(),
            trials: 0,
            right: 0,
            was_up: None,
        }
    }

    /// Takes an answer, and returns whether it turned the direction.
    pub(super) fn answer(&mut self, plan: &Staircase, is_right: bool) -> bool {
        self.trials += 1;
        self.right = if is_right { self.right + 1 } else { 0 };
        if is_right && self.right < plan.rule.needed() {
            return false;
        }
        self.right = 0;
        let is_up = !is_right;
        let has_turned = self.was_up.is_some_and(|was_up| was_up != is_up);
        if has_turned {
            self.reversals.push(self.level);
        }
        self.was_up = Some(is_up);
        let place = self.reversals.len().min(plan.steps.len().saturating_sub(1));
        let down = plan.steps.get(place).copied().unwrap_or_default();
        let step = match (is_up, plan.rule) {
            (false, _) => -down,
            (true, Rule::Weighted) => down * plan.target() / (1.0 - plan.target()),
            (true, _) => down,
        };
        let next = match plan.scale {
            Scale::Linear => self.level + step,
            Scale::Log => self.level * 10.0_f64.powf(step),
        };
        self.level = rounded(next.clamp(plan.least, plan.most));
        has_turned
    }

    pub(super) const fn is_over(&self, plan: &Staircase) -> bool {
        self.reversals.len() >= plan.reversals || self.trials >= plan.trials
    }
}

/// A level with twelve digits: one that is reached again by other steps is the same.
fn rounded(level: f64) -> f64 {
    format!("{level:.11e}").parse().unwrap_or(level)
}

#[cfg(test)]
mod tests;

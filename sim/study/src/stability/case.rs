//! A hard case: what makes it hard, its exact inputs, and what must hold.

use super::criterion::Criterion;
use super::input::Input;
use super::subject::{Rung, Subject};
use super::text::Plain;
use crepitus_model::parameters::Tabled;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Settings};
use std::fmt::Write;

/// A hard case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its number in the catalogue: `H01`.
    pub id: &'static str,
    /// Its name on the command line: `constant-speed`.
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// What makes it hard.
    pub hard: &'static str,
    /// Where it and its number come from.
    pub source: &'static str,
    /// Hours of simulated time: only with `--long`.
    pub long: bool,
    /// Which subjects must hold; what the others do is shown.
    pub must: fn(Subject) -> bool,
    /// What a subject is put through; nothing where the case says nothing
    /// about it.
    pub trials: fn(Subject) -> Vec<Trial>,
}

/// One run of a case and what must hold in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The joint.
    pub settings: Settings,
    /// What drives it.
    pub input: Input,
    /// What must hold beside the common bounds.
    pub criteria: Vec<Criterion>,
}

impl Trial {
    /// The joint and its input in words; the joint only where it differs from
    /// the paper's.
    pub fn describe(&self) -> String {
        let p = &self.settings.parameters;
        let paper = Parameters::default();
        let mut text = String::new();
        for ((spec, value), default) in Parameters::TABLE.iter().zip(p.values()).zip(paper.values())
        {
            if value != default {
                let value = Plain(value);
                // Writing to a string cannot fail.
                let _ = write!(text, "{} = {value} {}, ", spec.symbol, spec.unit);
            }
        }
        text + &self.input.to_string()
    }
}

impl Case {
    /// What goes in, in words: every trial of every subject, none twice.
    pub fn inputs(&self) -> Vec<String> {
        self.collect(|trial| vec![trial.describe()])
    }

    /// What must hold, in words, none twice.
    pub fn criteria(&self) -> Vec<String> {
        self.collect(|trial| trial.criteria.iter().map(ToString::to_string).collect())
    }

    /// What this subject is put through; nothing where the case says nothing
    /// about it. A rung that needs the exact motion is given no other; the
    /// reference, what it has a meaning for: a motion that is prescribed and
    /// not sampled.
    pub fn trials_of(&self, subject: Subject) -> Vec<Trial> {
        let mut trials = (self.trials)(subject);
        if subject.solver.needs_exact_motion() {
            trials.retain(|trial| trial.input.is_exact());
        }
        if subject.solver == Rung::Reference {
            trials.retain(|trial| trial.input.suits_the_reference());
            for trial in &mut trials {
                trial.criteria.retain(Criterion::suits_the_reference);
                if trial.criteria.is_empty() {
                    trial.criteria.push(Criterion::Survives);
                }
            }
        }
        trials
    }

    fn collect(&self, texts: impl Fn(&Trial) -> Vec<String>) -> Vec<String> {
        let mut all = Vec::new();
        for subject in Subject::all() {
            for text in self.trials_of(subject).iter().flat_map(&texts) {
                if !all.contains(&text) {
                    all.push(text);
                }
            }
        }
        all
    }
}

/// Who must hold unless a case says otherwise: `exact-events` and the reference
/// everywhere, and under `frozen` also `exact-break`, which is the same there.
pub fn located(subject: Subject) -> bool {
    match subject.solver {
        Rung::Reference | Rung::Ladder(Solver::ExactEvents) => true,
        Rung::Ladder(Solver::ExactBreak) => subject.convention == Convention::Frozen,
        Rung::Ladder(_) => false,
    }
}

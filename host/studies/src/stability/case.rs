//! A hard case: why it is hard, its exact inputs, and its criteria.

use super::criteria::survives;
use super::criterion::{Basis, Criterion};
use super::input::{Input, unlike_the_paper};
use super::subject::{Rung, Subject};
use crepitus_model::parameters::Tabled;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Settings};

/// A hard case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number in the catalogue: `H01`.
    pub id: &'static str,
    /// Name on the command line: `constant-speed`.
    pub name: &'static str,
    /// Title of the case.
    pub title: &'static str,
    /// Reason why it is hard.
    pub hard: &'static str,
    /// Source of the case and of its limits.
    pub source: &'static str,
    /// Hours of simulated time: only with `--long`.
    pub long: bool,
    /// Subjects that it applies to.
    pub of: fn(Subject) -> bool,
    /// Subjects that must hold; the others are only shown.
    pub must: fn(Subject) -> bool,
    /// The trials of a subject, whose convention they get.
    pub trials: fn(Subject) -> Vec<Trial>,
}

/// One run of a case and its criteria.
#[derive(Clone)]
pub struct Trial {
    /// The joint.
    pub settings: Settings,
    /// Input of the joint.
    pub input: Input,
    /// Criteria beside the common bounds.
    pub criteria: Vec<Criterion>,
}

impl Input {
    /// A trial with this input, of the paper's joint.
    pub(super) fn meets(self, criteria: impl Into<Vec<Criterion>>) -> Trial {
        Trial {
            settings: Settings::default(),
            input: self,
            criteria: criteria.into(),
        }
    }
}

impl Trial {
    /// The trial of a joint with these J, kr, c, Tk and Ts.
    pub(super) fn with(mut self, values: [f64; 5]) -> Self {
        self.settings.parameters = Parameters::of(values);
        self
    }

    /// Describes the joint, where it differs from the paper's, and its input.
    pub fn describe(&self) -> String {
        let mut parts = unlike_the_paper(&self.settings.parameters);
        parts.push(self.input.to_string());
        parts.join(", ")
    }
}

impl Case {
    /// Descriptions of the inputs of all trials of all subjects, without
    /// duplicates.
    pub fn inputs(&self) -> Vec<String> {
        self.collect(|trial| vec![trial.describe()])
    }

    /// Descriptions of the criteria, without duplicates.
    pub fn criteria(&self) -> Vec<String> {
        self.collect(|trial| trial.criteria.iter().map(ToString::to_string).collect())
    }

    /// The trials of this subject; empty if the case does not apply to it. A
    /// rung that needs the exact motion gets no other; the reference only
    /// motions that are prescribed and not sampled.
    pub fn trials_of(&self, subject: Subject) -> Vec<Trial> {
        if !(self.of)(subject) {
            return Vec::new();
        }
        let mut trials = (self.trials)(subject);
        for trial in &mut trials {
            trial.settings.convention = subject.convention;
        }
        if subject.solver.needs_exact_motion() {
            trials.retain(|trial| trial.input.is_exact());
        }
        if subject.solver == Rung::Reference {
            trials.retain(|trial| trial.input.suits_the_reference());
            for trial in &mut trials {
                trial.criteria.retain(|c| c.basis == Basis::Run);
                if trial.criteria.is_empty() {
                    trial.criteria.push(survives());
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

/// The subjects that must hold by default: `exact-events` and the reference,
/// and under `frozen` also `exact-break`, which is the same there.
pub(super) fn located(subject: Subject) -> bool {
    match subject.solver {
        Rung::Reference | Rung::Ladder(Solver::ExactEvents) => true,
        Rung::Ladder(Solver::ExactBreak) => subject.convention == Convention::Frozen,
        Rung::Ladder(_) => false,
    }
}

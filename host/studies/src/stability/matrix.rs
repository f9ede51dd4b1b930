//! The matrix of cases and subjects.

use super::case::{Case, Trial};
use super::criterion::{Basis, Evidence, common};
use super::input::{Input, What};
use super::observation::Observation;
use super::observe::observe;
use super::subject::Subject;
use super::verdict::{Failure, Verdict};
use crate::true_events::{TrueEvent, true_events};
use crate::watcher::{Cancelled, StudyError, Watcher};
use crepitus_model::{Real, Settings, SettingsError};
use serde::Serialize;
use std::rc::Rc;
use std::time::Instant;

/// Plan of a run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The cases.
    pub cases: Vec<Case>,
    /// The subjects.
    pub subjects: Vec<Subject>,
}

/// One subject in one case.
#[derive(Clone, Debug)]
pub struct Cell {
    /// The subject.
    pub subject: Subject,
    /// Whether it must hold: the tool and the tests fail if it does not.
    pub must_hold: bool,
    /// Verdict of the worst of the case's trials.
    pub verdict: Verdict,
    /// That trial, and its criterion.
    pub detail: String,
}

/// One case and the subjects that it applies to.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: Case,
    /// Cells of the case, in the order of [`Subject::all`].
    pub cells: Vec<Cell>,
}

/// All rows, in the order of the catalogue.
#[derive(Clone, Debug, Default)]
pub struct Matrix {
    /// The rows.
    pub rows: Vec<Row>,
    /// Duration of the run, s.
    pub wall_s: f64,
}

impl Matrix {
    /// All cells with their cases.
    pub fn cells(&self) -> impl Iterator<Item = (&Case, &Cell)> {
        let rows = self.rows.iter();
        rows.flat_map(|row| row.cells.iter().map(|cell| (&row.case, cell)))
    }

    /// The cells that must hold and do not.
    pub fn broken(&self) -> impl Iterator<Item = (&Case, &Cell)> {
        self.cells().filter(|(_, cell)| cell.is_broken())
    }
}

/// Numbers of cells: by verdict, those that must hold, and those that must hold and do not.
#[derive(Clone, Copy, Default, Serialize)]
pub(super) struct Counts {
    pub(super) holds: usize,
    pub(super) degrades: usize,
    pub(super) fails: usize,
    pub(super) must_hold: usize,
    pub(super) broken: usize,
}

impl Counts {
    pub(super) fn of<'c>(cells: impl IntoIterator<Item = &'c Cell>) -> Self {
        let mut counts = Self::default();
        for cell in cells {
            match cell.verdict {
                Verdict::Holds(_) => counts.holds += 1,
                Verdict::Degrades { .. } => counts.degrades += 1,
                Verdict::Fails { .. } => counts.fails += 1,
            }
            counts.must_hold += usize::from(cell.must_hold);
            counts.broken += usize::from(cell.is_broken());
        }
        counts
    }
}

impl Cell {
    /// Returns whether it must hold and does not.
    pub(super) fn is_broken(&self) -> bool {
        self.must_hold && !self.verdict.holds()
    }
}

/// Runs a plan.
///
/// # Errors
/// Error of the watcher, or a trial whose settings are refused.
pub fn run(plan: &Plan, watcher: &mut dyn Watcher) -> Result<Matrix, StudyError> {
    let begun = Instant::now();
    let mut work = Work {
        watcher,
        total: total_work(plan),
        done: 0.0,
    };
    let mut matrix = Matrix::default();
    for case in &plan.cases {
        let mut truths = Truths::default();
        let mut cells = Vec::new();
        for &subject in &plan.subjects {
            let trials = case.trials_of(subject);
            if trials.is_empty() {
                continue;
            }
            let (verdict, detail) = worst_verdict(subject, &trials, &mut truths, &mut work)?;
            cells.push(Cell {
                subject,
                must_hold: (case.must)(subject),
                verdict,
                detail,
            });
        }
        matrix.rows.push(Row {
            case: case.clone(),
            cells,
        });
    }
    matrix.wall_s = begun.elapsed().as_secs_f64();
    Ok(matrix)
}

/// Verdict of a subject in the worst of some trials, with that trial.
fn worst_verdict(
    subject: Subject,
    trials: &[Trial],
    truths: &mut Truths,
    work: &mut Work<'_>,
) -> Result<(Verdict, String), StudyError> {
    let mut worst: Option<(Verdict, String)> = None;
    let mut add = |verdict: Verdict, detail: String| {
        if worst.as_ref().is_none_or(|(w, _)| rank(&verdict) > rank(w)) {
            worst = Some((verdict, detail));
        }
    };
    for trial in trials {
        let seen = work.observe(subject, &trial.settings, &trial.input, late_s(trial))?;
        let truth = truths.of(trial)?;
        let flagged = seen.is_flagged();
        let evidence = Evidence {
            subject,
            seen: &seen,
            truth: &truth,
            twin: None,
        };
        if let Some(verdict) = common(&evidence) {
            let detail = format!("{}: the common bounds", trial.describe());
            add(verdict.flag(flagged), detail);
        }
        for criterion in &trial.criteria {
            let twin = match &criterion.twin {
                Some(input) => Some(work.observe(subject, &trial.settings, input, 0.0)?),
                None => None,
            };
            let evidence = Evidence {
                twin: twin.as_ref(),
                ..evidence
            };
            let remark = criterion.remark(&seen);
            let detail = format!("{}: {criterion}{remark}", trial.describe());
            add(criterion.judge(&evidence).flag(flagged), detail);
        }
    }
    Ok(worst.unwrap_or((Verdict::MET, String::new())))
}

/// The time from which a trial checks the torque, s.
fn late_s(trial: &Trial) -> f64 {
    let mut criteria = trial.criteria.iter();
    criteria.find_map(|c| c.from_s).unwrap_or(0.0)
}

/// Rank of a verdict, larger if worse: first by kind, then by the used share
/// of the limit.
fn rank(verdict: &Verdict) -> (u8, f64) {
    match verdict {
        Verdict::Holds(margin) => (0, margin.share()),
        Verdict::Degrades { margin, .. } => (1, margin.share()),
        Verdict::Fails { what, .. } => match *what {
            Failure::OtherEvents { found, expected } => (2, off(found, expected)),
            Failure::Broken(_) => (2, 0.0),
            Failure::AboveTheLimit => (3, 0.0),
            Failure::Overflow => (4, 0.0),
        },
    }
}

/// Relative difference of two counts, from 0 to 1.
fn off(found: u64, expected: u64) -> f64 {
    f64::from_whole(found.abs_diff(expected)) / f64::from_whole(found.max(expected).max(1))
}

/// The true events of a case's trials, shared by subjects.
#[derive(Debug, Default)]
struct Truths(Vec<(Settings, Input, Rc<Vec<TrueEvent>>)>);

impl Truths {
    fn of(&mut self, trial: &Trial) -> Result<Rc<Vec<TrueEvent>>, SettingsError> {
        let Trial {
            settings, input, ..
        } = trial;
        let is_wanted = trial.criteria.iter().any(|c| c.basis == Basis::Truth);
        if !is_wanted || !matches!(input.what, What::Sampled(_)) {
            return Ok(Rc::default());
        }
        let known = self.0.iter().find(|(s, i, _)| s == settings && i == input);
        if let Some((_, _, events)) = known {
            return Ok(events.clone());
        }
        let motion = input.motion();
        let end_s = input.sampling(&motion).end_s();
        let events = Rc::new(true_events(&settings.validate()?, &motion, end_s));
        self.0.push((*settings, input.clone(), events.clone()));
        Ok(events)
    }
}

/// Reports progress to the watcher.
struct Work<'a> {
    watcher: &'a mut dyn Watcher,
    total: f64,
    done: f64,
}

impl Work<'_> {
    fn observe(
        &mut self,
        subject: Subject,
        settings: &Settings,
        input: &Input,
        late_s: f64,
    ) -> Result<Observation, StudyError> {
        // A run that overflows ends early: all its work counts as done.
        let after = self.done + work_of(input);
        let seen = observe(subject, settings, input, late_s, &mut |steps| {
            self.done += steps;
            self.report_progress()
        })?;
        self.done = after;
        self.report_progress()?;
        Ok(seen)
    }

    fn report_progress(&mut self) -> Result<(), Cancelled> {
        self.watcher.progress((self.done / self.total).min(1.0))
    }
}

/// Work of one run, in steps; building a joint counts a little too.
fn work_of(input: &Input) -> f64 {
    input.steps() + 100.0
}

/// All work of a plan, in steps.
fn total_work(plan: &Plan) -> f64 {
    let mut total = 0.0;
    for case in &plan.cases {
        for &subject in &plan.subjects {
            for trial in case.trials_of(subject) {
                total += work_of(&trial.input);
                let twins = trial.criteria.iter().filter_map(|c| c.twin.as_ref());
                total += twins.map(work_of).sum::<f64>();
            }
        }
    }
    total
}

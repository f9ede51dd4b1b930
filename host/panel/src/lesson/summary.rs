//! Results of a lesson, for every student and for all together.

use crate::lesson::lesson::{Answer, Lesson};
use crepitus_scene::preset::{Disorder, Level};
use crepitus_studies::experiment::agreement::{Kappa, Table, Weights};
use crepitus_studies::experiment::finding::{Finding, Knee};
use serde::Serialize;

/// Results of a lesson: `summary` of the page's message.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number of answers.
    pub answers: usize,
    /// Number of answers with the right disorder.
    pub right: usize,
    /// Results of each student, in the order of the students.
    pub students: Vec<StudentScores>,
    /// Results of all answers together. Answers of several students to the same knee are not
    /// independent: the interval of this kappa is too narrow.
    pub all: Scores,
    /// Remarks on how to read the numbers: keys of texts, after `report.`.
    pub remarks: Vec<&'static str>,
}

/// Results of a student.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudentScores {
    /// Pseudonym.
    pub student: String,
    /// Results.
    #[serde(flatten)]
    pub scores: Scores,
}

/// Results of some answers, of those that [count](Answer::counts).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// Number of answers.
    pub answers: usize,
    /// Number of answers that do not count: there was no torque for too much of the time.
    pub without_torque: usize,
    /// Number of answers with the right disorder.
    pub right: usize,
    /// Mean confidence, 1 to 5, of the answers with the right disorder.
    pub confidence_right: Option<f64>,
    /// Mean confidence, 1 to 5, of the others.
    pub confidence_wrong: Option<f64>,
    /// Cohen's kappa of the disorder.
    pub kappa: Option<Interval>,
    /// Linearly weighted kappa of the level.
    pub level_kappa: Option<Interval>,
    /// Numbers of answers, by knee and answer.
    pub confusion: Confusion,
}

/// An estimate with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Estimate.
    pub value: f64,
    /// Lower limit.
    pub low: f64,
    /// Upper limit.
    pub high: f64,
}

impl From<Kappa> for Interval {
    fn from(kappa: Kappa) -> Self {
        let (low, high) = kappa.interval();
        Self {
            value: kappa.value,
            low,
            high,
        }
    }
}

/// Confusion matrix of the disorder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Confusion {
    /// Disorders that the knees had.
    pub rows: Vec<Finding>,
    /// Disorders that the knees had or that were answered.
    pub columns: Vec<Finding>,
    /// Number of answers, by row and column.
    pub counts: Vec<Vec<usize>>,
}

impl Summary {
    /// Results of the answers so far.
    pub fn of(lesson: &Lesson) -> Self {
        let answers = || lesson.answers().iter();
        let students = lesson.students().iter().map(|student| StudentScores {
            student: student.clone(),
            scores: Scores::of(lesson, answers().filter(|a| a.student == *student)),
        });
        let students: Vec<_> = students.collect();
        let all = Scores::of(lesson, answers());
        Self {
            answers: all.answers,
            right: all.right,
            remarks: remarks(&students, &all),
            students,
            all,
        }
    }
}

/// Fewest answers whose interval is more than rough.
const ENOUGH: usize = 20;

/// Remarks on these results.
fn remarks(students: &[StudentScores], all: &Scores) -> Vec<&'static str> {
    let is_any = |has: fn(&Scores) -> bool| students.iter().any(|student| has(&student.scores));
    let has_no_width = |scores: &Scores| {
        let both = [scores.kappa, scores.level_kappa];
        both.iter().flatten().any(|kappa| kappa.low >= kappa.high)
    };
    let remarks = [
        ("about_kappa", true),
        ("left_out", all.without_torque > 0),
        ("few", is_any(|scores| scores.answers < ENOUGH)),
        ("no_width", is_any(has_no_width)),
        ("pooled", students.len() > 1),
    ];
    let said = remarks.into_iter().filter(|(_, is_said)| *is_said);
    said.map(|(key, _)| key).collect()
}

/// Number of findings: healthy and every disorder.
const FINDINGS: usize = 1 + Disorder::ALL.len();

/// Number of grades: none, which a healthy knee has, and every level.
const GRADES: usize = 1 + Level::ALL.len();

impl Scores {
    /// Results of these answers.
    fn of<'a>(lesson: &'a Lesson, answers: impl Iterator<Item = &'a Answer>) -> Self {
        let mut disorders = Table::<FINDINGS>::default();
        let mut levels = Table::<GRADES>::default();
        let (mut right, mut wrong) = (Mean::default(), Mean::default());
        let mut without_torque = 0;
        for answer in answers {
            if !answer.counts() {
                without_torque += 1;
                continue;
            }
            let knee = lesson.knee_of(answer.trial);
            if let Some(truth) = knee.disorder {
                disorders.count(place(truth), place(answer.disorder));
            }
            let graded = (
                grade(knee.disorder, knee.level),
                grade(Some(answer.disorder), answer.level),
            );
            if let (Some(truth), Some(answered)) = graded {
                levels.count(truth, answered);
            }
            let mean = if answer.is_right(knee) {
                &mut right
            } else {
                &mut wrong
            };
            mean.add(answer.confidence);
        }
        Self {
            answers: right.count + wrong.count,
            without_torque,
            right: right.count,
            confidence_right: right.mean(),
            confidence_wrong: wrong.mean(),
            kappa: kappa(&disorders, Weights::Nominal),
            level_kappa: kappa(&levels, Weights::Linear),
            confusion: Confusion::of(&disorders),
        }
    }
}

/// Kappa with its interval, if the knees differ: kappa is 0 for every answer where the truth is
/// always the same.
fn kappa<const K: usize>(table: &Table<K>, weights: Weights) -> Option<Interval> {
    if table.truths() < 2 {
        return None;
    }
    table.kappa(weights).map(Interval::from)
}

impl Confusion {
    fn of(table: &Table<FINDINGS>) -> Self {
        let Table(counts) = table;
        let is_truth = |i: usize| counts.get(i).is_some_and(|row| row.iter().any(|n| *n > 0));
        let is_answer = |j: usize| counts.iter().any(|row| row.get(j).is_some_and(|n| *n > 0));
        let findings = || Finding::all().enumerate();
        let columns: Vec<_> = findings()
            .filter(|(at, _)| is_truth(*at) || is_answer(*at))
            .collect();
        let rows: Vec<_> = findings().filter(|(at, _)| is_truth(*at)).collect();
        let count = |i: usize, j: usize| {
            let row = counts.get(i);
            row.and_then(|row| row.get(j)).copied().unwrap_or(0)
        };
        let row = |i: usize| columns.iter().map(|(j, _)| count(i, *j)).collect();
        Self {
            counts: rows.iter().map(|(i, _)| row(*i)).collect(),
            rows: rows.iter().map(|(_, finding)| *finding).collect(),
            columns: columns.iter().map(|(_, finding)| *finding).collect(),
        }
    }
}

impl Answer {
    /// Returns whether the disorder is that of the knee.
    pub fn is_right(&self, knee: &Knee) -> bool {
        knee.disorder == Some(self.disorder)
    }

    /// Returns whether the level is that of the knee; `None` if one of them has none. A healthy knee has
    /// the level "none".
    pub fn is_level_right(&self, knee: &Knee) -> Option<bool> {
        let truth = grade(knee.disorder, knee.level)?;
        let answered = grade(Some(self.disorder), self.level)?;
        Some(truth == answered)
    }
}

/// Place of a finding in a table.
fn place(finding: Finding) -> usize {
    // Every finding is in the list.
    let mut all = Finding::all();
    all.position(|other| other == finding).unwrap_or(FINDINGS)
}

/// Place of a level in a table: 0 for a healthy knee; `None` if the level is unknown.
fn grade(finding: Option<Finding>, level: Option<Level>) -> Option<usize> {
    if finding == Some(Finding::Healthy) {
        return Some(0);
    }
    let level = level?;
    let mut all = Level::ALL.into_iter();
    all.position(|other| other == level).map(|place| place + 1)
}

/// Mean of small numbers.
#[derive(Default)]
struct Mean {
    count: usize,
    sum: u32,
}

impl Mean {
    fn add(&mut self, number: u8) {
        self.count += 1;
        self.sum += u32::from(number);
    }

    // Far below 2^53.
    #[allow(clippy::cast_precision_loss)]
    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| f64::from(self.sum) / self.count as f64)
    }
}

#[cfg(test)]
mod tests;

//! The `lesson` message of the page: what may be seen of a lesson at this moment.
//!
//! The message holds no knee that is hidden, so every teacher's page gets it. Viewers get its [public](View::public)
//! part, a student [their own](crate::lesson::OwnView).

use crate::lesson::lesson::{Answer, Lesson};
use crate::lesson::plan::Feedback;
use crate::lesson::summary::Summary;
use crepitus_scene::preset::Level;
use crepitus_studies::experiment::finding::{Finding, Knee, level_name};
use serde::Serialize;

/// A lesson as the page shows it.
#[derive(Clone, Debug, PartialEq, Serialize)]
// Flags of the message, each with its own meaning.
#[allow(clippy::struct_excessive_bools)]
pub struct View {
    /// Title of the plan.
    pub title: String,
    /// Description of the plan.
    pub description: String,
    /// Whether the knees are hidden.
    pub blind: bool,
    /// Whether the torque curves are shown while the knee is hidden.
    pub curves: bool,
    /// Time at which answers are judged.
    pub feedback: Feedback,
    /// Seed of the order; `None` for those who could look up the knees with it.
    pub seed: Option<u64>,
    /// Name of the lesson.
    pub name: String,
    /// Folder of the session, if it is stored.
    pub stored: Option<String>,
    /// Pseudonyms.
    pub students: Vec<String>,
    /// The current trial, from 1.
    pub trial: usize,
    /// Number of trials.
    pub trials: usize,
    /// Instruction for this trial.
    pub instruction: String,
    /// Name of the target speed.
    pub target: Option<String>,
    /// Time for this trial, s.
    pub time_s: Option<f64>,
    /// Whether the current trial has begun.
    pub began: bool,
    /// The knee; `None` while it is hidden.
    pub knee: Option<Knee>,
    /// Answers to all trials so far.
    pub answers: Vec<AnswerView>,
    /// Whether the lesson has ended.
    pub ended: bool,
    /// Answers that can be given.
    pub choices: Choices,
    /// Results, once a blind lesson has ended.
    pub summary: Option<Summary>,
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnswerView {
    /// Pseudonym.
    pub student: String,
    /// Trial, from 1.
    pub trial: usize,
    /// Disorder; `None` while the knee is hidden: students judge without each other.
    pub disorder: Option<Finding>,
    /// Level; `None` while the knee is hidden, and if none was given.
    #[serde(with = "level_name")]
    pub level: Option<Level>,
    /// Confidence, 1 to 5; `None` while the knee is hidden.
    pub confidence: Option<u8>,
    /// Whether the disorder is right; `None` while it is hidden.
    pub right: Option<bool>,
    /// Whether the level is right; `None` while it is hidden, and where the knee or the answer
    /// has no level.
    pub level_right: Option<bool>,
    /// Whether it counts: the motor was driven for long enough.
    pub counts: bool,
    /// Share of the trial's time up to it in which the motor was driven.
    pub torque_share: Option<f64>,
}

/// Disorders and levels that can be answered.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Choices {
    /// Disorders, "healthy" first.
    pub disorders: Vec<&'static str>,
    /// Levels, ascending.
    pub levels: Vec<&'static str>,
}

impl Choices {
    /// All.
    pub(crate) fn all() -> Self {
        Self {
            disorders: Finding::all().map(Finding::name).collect(),
            levels: Level::ALL.map(Level::name).to_vec(),
        }
    }
}

impl Lesson {
    /// Visible part of the lesson; `stored` is the folder of the session, if it is stored.
    pub fn view(&self, stored: Option<&str>) -> View {
        let plan = self.plan();
        let trial = self.trial();
        let planned = self.planned(trial);
        View {
            title: plan.title.clone(),
            description: plan.description.clone(),
            blind: plan.blind,
            curves: plan.curves,
            feedback: plan.feedback,
            seed: Some(self.seed()),
            name: self.name().to_owned(),
            stored: stored.map(str::to_owned),
            students: self.students().to_vec(),
            trial,
            trials: self.trials(),
            instruction: self.instruction().to_owned(),
            target: planned.and_then(|knee| knee.target.clone()),
            time_s: planned.and_then(|knee| knee.time_s),
            began: self.began(),
            knee: (!self.is_hidden()).then(|| self.knee().clone()),
            answers: self.answers().iter().map(|a| self.judged(a)).collect(),
            ended: self.ended(),
            choices: Choices::all(),
            summary: (plan.blind && self.ended()).then(|| Summary::of(self)),
        }
    }

    /// Instruction for the current trial.
    pub(super) fn instruction(&self) -> &str {
        let planned = self.planned(self.trial());
        let own = planned.and_then(|knee| knee.instruction.as_deref());
        let all = self.plan().instruction.as_deref();
        own.or(all).unwrap_or_default()
    }

    /// An answer, judged as far as the knee is revealed.
    pub(super) fn judged(&self, answer: &Answer) -> AnswerView {
        let revealed = self.is_revealed(answer.trial);
        let knee = self.knee_of(answer.trial);
        AnswerView {
            student: answer.student.clone(),
            trial: answer.trial,
            disorder: revealed.then_some(answer.disorder),
            level: answer.level.filter(|_| revealed),
            confidence: revealed.then_some(answer.confidence),
            right: revealed.then(|| answer.is_right(knee)),
            level_right: answer.is_level_right(knee).filter(|_| revealed),
            counts: answer.counts(),
            torque_share: answer.torque_share,
        }
    }
}

impl View {
    /// Part for viewers: of the answers no more than who has given one, of the results those of all together,
    /// and the seed once nothing can be looked up with it.
    #[must_use]
    pub fn public(mut self) -> Self {
        self.stored = None;
        self.seed = self.seed.filter(|_| self.ended || !self.blind);
        for answer in &mut self.answers {
            (answer.disorder, answer.level, answer.confidence) = (None, None, None);
            (answer.right, answer.level_right) = (None, None);
        }
        if let Some(summary) = &mut self.summary {
            summary.students.clear();
        }
        self
    }
}

#[cfg(test)]
mod tests;

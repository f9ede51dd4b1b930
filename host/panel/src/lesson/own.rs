//! The part of a lesson that a student's phone shows.
//!
//! It holds nothing of the other students, and of a knee only what is revealed.

use crate::lesson::lesson::{Answer, Lesson};
use crate::lesson::summary::{Scores, Summary};
use crate::lesson::view::{AnswerView, Choices};
use crepitus_studies::experiment::finding::Knee;
use serde::Serialize;

/// A lesson as a student sees it.
#[derive(Clone, Debug, PartialEq, Serialize)]
// Flags of the message, each with its own meaning.
#[allow(clippy::struct_excessive_bools)]
pub struct OwnView {
    /// Title of the plan.
    pub title: String,
    /// Name of the lesson.
    pub name: String,
    /// Whether the knees are hidden.
    pub blind: bool,
    /// The current trial, from 1.
    pub trial: usize,
    /// Number of trials.
    pub trials: usize,
    /// Instruction for this trial.
    pub instruction: String,
    /// Whether the current trial has begun.
    pub began: bool,
    /// Whether the lesson has ended.
    pub ended: bool,
    /// Whether an answer to the current trial can be given, or replaced.
    pub takes_answer: bool,
    /// The knee of the current trial; `None` while it is hidden.
    pub knee: Option<Knee>,
    /// The student's answers so far.
    pub answers: Vec<OwnAnswer>,
    /// Answers that can be given.
    pub choices: Choices,
    /// Results, once a blind lesson has ended.
    pub scores: Option<Scores>,
}

/// An answer of the student: its content at any time, the verdict once the knee is revealed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OwnAnswer {
    /// Answer and verdict.
    #[serde(flatten)]
    pub answer: AnswerView,
    /// The knee of its trial; `None` while it is hidden.
    pub knee: Option<Knee>,
}

impl Lesson {
    /// Part of the lesson for a student; `None` for one who is not in it.
    pub fn own_view(&self, student: &str) -> Option<OwnView> {
        let student = self.student(student)?;
        let trial = self.trial();
        let blind = self.plan().blind;
        let own = self.answers().iter().filter(|a| a.student == student);
        Some(OwnView {
            title: self.plan().title.clone(),
            name: self.name().to_owned(),
            blind,
            trial,
            trials: self.trials(),
            instruction: self.instruction().to_owned(),
            began: self.began(),
            ended: self.ended(),
            takes_answer: blind && self.began() && self.is_hidden(),
            knee: self.revealed(trial),
            answers: own.map(|answer| self.own_answer(answer)).collect(),
            choices: Choices::all(),
            scores: self.scores_of(student),
        })
    }

    fn own_answer(&self, answer: &Answer) -> OwnAnswer {
        OwnAnswer {
            answer: AnswerView {
                disorder: Some(answer.disorder),
                level: answer.level,
                confidence: Some(answer.confidence),
                ..self.judged(answer)
            },
            knee: self.revealed(answer.trial),
        }
    }

    /// The knee of a trial, if it may be known.
    fn revealed(&self, trial: usize) -> Option<Knee> {
        let knee = || self.knee_of(trial).clone();
        self.is_revealed(trial).then(knee)
    }

    /// Results of a student, once a blind lesson has ended.
    fn scores_of(&self, student: &str) -> Option<Scores> {
        if !self.plan().blind || !self.ended() {
            return None;
        }
        let mut all = Summary::of(self).students.into_iter();
        let own = all.find(|one| one.student == student)?;
        Some(own.scores)
    }
}

#[cfg(test)]
mod tests;

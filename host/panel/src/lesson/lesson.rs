//! A lesson as a state machine.
//!
//! ```text
//!                     ┌──────────── next ────────────┐
//!                     ▼                              │
//!  begin ──────> trial k, waiting ── start ──> trial k, running ── answer (blind), any number
//!                     │                              │
//!                     └───────── end ────────────────┴───────────> ended
//! ```
//!
//! After the last trial `next` is rejected; `end` is allowed at any time, also before every knee
//! was examined.
//!
//! **What is hidden.** In an open lesson nothing is, and nothing is answered. In a blind lesson the
//! knee of a trial, and which answers to it are right, are revealed
//!
//! - with feedback after each knee: once every student has answered, or the trial was left;
//! - with feedback at the end: once the lesson has ended.
//!
//! **Answers.** One by each student and trial. A second one replaces the first as long as the
//! trial is the current one and its knee is hidden; once the knee is revealed, an answer is
//! rejected. A trial that was left without an answer stays without.
//!
//! **What counts.** An answer counts if the motor was driven for at least [`LEAST_TORQUE_SHARE`] of the
//! time from the start of its trial on: who felt a brace without torque has felt no knee. Others are kept, and are
//! left out of the results.
//!
//! There is no clock here: times are seconds of the time axis that the page shows, given by the
//! caller.

mod error;
mod students;

pub use error::{BeginError, LessonError};
pub(crate) use students::{check_pseudonym, is_same_name};

use crate::lesson::plan::{CheckedPlan, Feedback, Plan, PlannedKnee};
use crepitus_scene::preset::Level;
use crepitus_studies::experiment::finding::{Finding, Knee, find_level, level_name};
use crepitus_studies::experiment::order;
pub use crepitus_studies::experiment::order::MOST_SEED;
use error::MOST_NOTE;
use serde::{Deserialize, Serialize};
use students::check_students;

/// Least share of the time from the start of a trial to an answer in which the motor was driven, for the
/// answer to count.
pub const LEAST_TORQUE_SHARE: f64 = 0.5;

/// A lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    pub(crate) name: String,
    pub(crate) plan: CheckedPlan,
    pub(crate) seed: u64,
    pub(crate) students: Vec<String>,
    /// Indices of the plan's knees, one a trial.
    pub(crate) order: Vec<usize>,
    /// The current trial, from 0.
    pub(crate) current: usize,
    pub(crate) began: bool,
    /// Share of the current trial's time so far in which the motor was driven; `None` if nobody has said.
    pub(crate) torque_share: Option<f64>,
    pub(crate) ended: bool,
    pub(crate) answers: Vec<Answer>,
    pub(crate) notes: Vec<Note>,
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// Pseudonym.
    pub student: String,
    /// Trial, from 1.
    pub trial: usize,
    /// Disorder.
    pub disorder: Finding,
    /// Level; `None` if the student gave none, and of a healthy knee.
    #[serde(with = "level_name")]
    pub level: Option<Level>,
    /// Confidence, 1 to 5.
    pub confidence: u8,
    /// Time, s.
    pub time_s: f64,
    /// Share of the trial's time up to it in which the motor was driven; `None` in sessions of
    /// earlier versions, which did not measure it.
    #[serde(default)]
    pub torque_share: Option<f64>,
}

impl Answer {
    /// Returns whether the knee was there to be felt: see [`LEAST_TORQUE_SHARE`].
    pub fn counts(&self) -> bool {
        self.torque_share
            .is_none_or(|share| share >= LEAST_TORQUE_SHARE)
    }
}

/// A note on the time line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Note {
    /// Time, s.
    pub time_s: f64,
    /// Trial, from 1.
    pub trial: usize,
    /// Text, one line.
    pub text: String,
    /// Author.
    pub by: By,
}

crepitus_model::named! {
    /// Author of a note.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum By {
        /// The teacher.
        Teacher => "teacher",
        /// The lesson: a trial began, the lesson ended.
        Lesson => "lesson",
    }
}

impl Lesson {
    /// Begins a lesson; `name` is that of the plan's file, or of the folder.
    ///
    /// # Errors
    /// [`BeginError`] if students or seed are invalid.
    pub fn begin(
        name: &str,
        plan: CheckedPlan,
        students: Vec<String>,
        seed: u64,
    ) -> Result<Self, BeginError> {
        check_students(&students, plan.plan().blind)?;
        if seed > MOST_SEED {
            return Err(BeginError::Seed { seed });
        }
        let repeats = plan.plan().repeats;
        let order = if plan.plan().blind {
            let knees: Vec<_> = plan.knees().iter().map(|knee| &knee.preset).collect();
            order::shuffled(&knees, repeats, seed)
        } else {
            order::planned(plan.knees().len(), repeats)
        };
        Ok(Self {
            name: name.to_owned(),
            plan,
            seed,
            students,
            order,
            current: 0,
            began: false,
            torque_share: None,
            ended: false,
            answers: Vec::new(),
            notes: Vec::new(),
        })
    }

    /// Starts the current trial, and returns the knee to apply.
    ///
    /// # Errors
    /// [`LessonError::Begun`], [`LessonError::Ended`].
    pub fn start(&mut self) -> Result<&Knee, LessonError> {
        self.check_running()?;
        if self.began {
            return Err(LessonError::Begun {
                trial: self.trial(),
            });
        }
        self.began = true;
        self.torque_share = None;
        Ok(self.knee())
    }

    /// Takes the share of the current trial's time so far in which the motor was driven, 0 to 1: that of the
    /// answers that follow.
    pub const fn set_torque_share(&mut self, share: f64) {
        self.torque_share = Some(share);
    }

    /// Takes a student's answer to the current trial.
    ///
    /// A healthy knee has no level: one that is given with it is dropped.
    ///
    /// # Errors
    /// [`LessonError`] if the lesson is open, the trial has not begun, the knee is revealed, or a
    /// part of the answer is unknown.
    pub fn answer(
        &mut self,
        student: &str,
        disorder: &str,
        level: Option<&str>,
        confidence: u8,
        time_s: f64,
    ) -> Result<(), LessonError> {
        self.check_running()?;
        let trial = self.trial();
        if !self.plan().blind {
            return Err(LessonError::Open);
        }
        if !self.began {
            return Err(LessonError::NotBegun { trial });
        }
        if self.is_revealed(trial) {
            return Err(LessonError::Revealed { trial });
        }
        if !self.students.iter().any(|other| other == student) {
            return Err(LessonError::UnknownStudent {
                student: student.to_owned(),
                students: self.students.clone(),
            });
        }
        let Some(finding) = Finding::find(disorder) else {
            let disorder = disorder.to_owned();
            return Err(LessonError::UnknownDisorder { disorder });
        };
        let unknown = |level: &str| LessonError::UnknownLevel {
            level: level.to_owned(),
        };
        let level = level.map(|name| find_level(name).ok_or_else(|| unknown(name)));
        let level = level.transpose()?;
        if !(1..=5).contains(&confidence) {
            return Err(LessonError::Confidence { confidence });
        }
        self.answers
            .retain(|answer| answer.trial != trial || answer.student != student);
        self.answers.push(Answer {
            student: student.to_owned(),
            trial,
            disorder: finding,
            level: level.filter(|_| finding != Finding::Healthy),
            confidence,
            time_s,
            torque_share: self.torque_share,
        });
        Ok(())
    }

    /// Goes on to the next trial.
    ///
    /// # Errors
    /// [`LessonError::NotBegun`], [`LessonError::LastTrial`], [`LessonError::Ended`].
    pub fn next_trial(&mut self) -> Result<(), LessonError> {
        self.check_running()?;
        let trial = self.trial();
        if !self.began {
            return Err(LessonError::NotBegun { trial });
        }
        if trial == self.order.len() {
            return Err(LessonError::LastTrial { trial });
        }
        self.current += 1;
        self.began = false;
        Ok(())
    }

    /// Takes the lesson up again after the program that held it was interrupted: no device has the knee of the
    /// current trial any more, so it has to be started again. Its answers stay. A trial whose knee was revealed
    /// stays begun: the next one follows.
    pub fn take_up(&mut self) {
        let is_over = self.plan().blind && self.is_revealed(self.trial());
        self.began = self.began && is_over;
    }

    /// Ends the lesson.
    ///
    /// # Errors
    /// [`LessonError::Ended`] if it has ended before.
    pub fn end(&mut self) -> Result<(), LessonError> {
        self.check_running()?;
        self.ended = true;
        Ok(())
    }

    /// Adds a note, also after the end.
    ///
    /// # Errors
    /// [`LessonError::Note`] if its text is empty or too long.
    pub fn note(&mut self, time_s: f64, text: &str, by: By) -> Result<(), LessonError> {
        let text = text.trim();
        let characters = text.chars().count();
        if !(1..=MOST_NOTE).contains(&characters) {
            return Err(LessonError::Note { characters });
        }
        self.notes.push(Note {
            time_s,
            trial: self.trial(),
            text: text.to_owned(),
            by,
        });
        Ok(())
    }

    /// Name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Plan.
    pub const fn plan(&self) -> &Plan {
        self.plan.plan()
    }

    /// Seed of the order.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Pseudonyms.
    pub fn students(&self) -> &[String] {
        &self.students
    }

    /// The current trial, from 1.
    pub const fn trial(&self) -> usize {
        self.current + 1
    }

    /// Number of trials.
    pub fn trials(&self) -> usize {
        self.order.len()
    }

    /// Returns whether the current trial has begun.
    pub const fn began(&self) -> bool {
        self.began
    }

    /// Returns whether the lesson has ended.
    pub const fn ended(&self) -> bool {
        self.ended
    }

    /// The knee of the current trial: the truth, for the device only.
    pub fn knee(&self) -> &Knee {
        self.knee_of(self.trial())
    }

    /// The knee of a trial, from 1.
    pub fn knee_of(&self, trial: usize) -> &Knee {
        static NONE: std::sync::LazyLock<Knee> = std::sync::LazyLock::new(Knee::healthy);
        let place = self.place_of(trial);
        // Every trial has a knee: `begin` and `Session::read` see to it.
        place
            .and_then(|place| self.plan.knees().get(place))
            .unwrap_or(&NONE)
    }

    /// Entry of the plan for a trial, from 1.
    pub(crate) fn planned(&self, trial: usize) -> Option<&PlannedKnee> {
        self.plan().knees.get(self.place_of(trial)?)
    }

    fn place_of(&self, trial: usize) -> Option<usize> {
        self.order.get(trial.checked_sub(1)?).copied()
    }

    /// Answers, in the order in which they were given.
    pub fn answers(&self) -> &[Answer] {
        &self.answers
    }

    /// Notes, in the order in which they were made.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Returns whether the knee of the current trial is hidden: parameters and torque must not be shown.
    pub fn is_hidden(&self) -> bool {
        !self.is_revealed(self.trial())
    }

    /// Returns whether the knee of a trial, from 1, may be known.
    pub fn is_revealed(&self, trial: usize) -> bool {
        if !self.plan().blind || self.ended {
            return true;
        }
        let left = trial < self.trial();
        let answered = || {
            let of_trial = |answer: &&Answer| answer.trial == trial;
            self.answers.iter().filter(of_trial).count() == self.students.len()
        };
        self.plan().feedback == Feedback::Each && (left || answered())
    }

    const fn check_running(&self) -> Result<(), LessonError> {
        if self.ended {
            return Err(LessonError::Ended);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;

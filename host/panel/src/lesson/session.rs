//! A session: a lesson that is held, and what its report needs. `session.json` holds all of it.

use crate::lesson::lesson::{Answer, Lesson, Note};
use crate::lesson::plan::{CheckedPlan, Plan};
use crepitus_studies::experiment::finding::Knee;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Version of `session.json`.
const FORMAT: u32 = 1;

/// A lesson that is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Begin.
    pub started: Started,
    /// Version of the program that holds it.
    pub tool: String,
    /// The lesson.
    pub lesson: Lesson,
    /// Recordings, one a trial at most.
    pub recordings: Vec<Recorded>,
}

/// A recording of a trial.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Trial, from 1.
    pub trial: usize,
    /// File name in the session's folder.
    pub file: String,
}

/// Date and time of day at which a session began; the caller chooses the time zone.
///
/// Text form: `2026-11-24 15:42:05`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Started([u16; 6]);

/// Error of a session that cannot be rebuilt.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// Not a session's JSON.
    #[error("not a session: {0}; expected the `session.json` that the panel writes")]
    Form(#[from] serde_json::Error),
    /// Written by a later version.
    #[error(
        "the session has format {format}; this version reads {FORMAT}: install a newer version of Crepitus"
    )]
    Format {
        /// Format of the session.
        format: u32,
    },
    /// Parts contradict each other.
    #[error("the session contradicts itself: {0}; the file was changed after it was written")]
    Contradiction(&'static str),
    /// A date that does not exist.
    #[error("{0:?} is not a date and time; expected a form as 2026-11-24 15:42:05")]
    Date(String),
}

/// `session.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    format: u32,
    started: Started,
    tool: String,
    name: String,
    plan: Plan,
    /// The truth: a preset of one's own may be gone when the session is read.
    knees: Vec<Knee>,
    seed: u64,
    order: Vec<usize>,
    students: Vec<String>,
    trial: usize,
    began: bool,
    ended: bool,
    answers: Vec<Answer>,
    notes: Vec<Note>,
    recordings: Vec<Recorded>,
}

/// The version alone, of a file that may have other keys.
#[derive(Deserialize)]
struct Version {
    format: u32,
}

impl Session {
    /// A session that begins now.
    pub const fn new(started: Started, tool: String, lesson: Lesson) -> Self {
        Self {
            started,
            tool,
            lesson,
            recordings: Vec::new(),
        }
    }

    /// Enters the recording of a trial, in place of an earlier one.
    pub fn recorded(&mut self, trial: usize, file: &str) {
        self.recordings.retain(|recorded| recorded.trial != trial);
        let file = file.to_owned();
        self.recordings.push(Recorded { trial, file });
    }

    /// File name of a trial's recording, if there is one.
    pub fn recording_of(&self, trial: usize) -> Option<&str> {
        let mut all = self.recordings.iter();
        all.find(|r| r.trial == trial).map(|r| r.file.as_str())
    }

    /// The session as JSON.
    ///
    /// # Errors
    /// Of the serializer; there is no value that it rejects.
    pub fn to_json(&self) -> Result<String, SessionError> {
        let lesson = &self.lesson;
        let record = Record {
            format: FORMAT,
            started: self.started,
            tool: self.tool.clone(),
            name: lesson.name.clone(),
            plan: lesson.plan.plan().clone(),
            knees: lesson.plan.knees().to_vec(),
            seed: lesson.seed,
            order: lesson.order.clone(),
            students: lesson.students.clone(),
            trial: lesson.trial(),
            began: lesson.began,
            ended: lesson.ended,
            answers: lesson.answers.clone(),
            notes: lesson.notes.clone(),
            recordings: self.recordings.clone(),
        };
        let mut text = serde_json::to_string_pretty(&record)?;
        text.push('\n');
        Ok(text)
    }

    /// The session of this JSON, checked.
    ///
    /// # Errors
    /// [`SessionError`].
    pub fn from_json(text: &str) -> Result<Self, SessionError> {
        let Version { format } = serde_json::from_str(text)?;
        if format != FORMAT {
            return Err(SessionError::Format { format });
        }
        let record: Record = serde_json::from_str(text)?;
        record.check().map_err(SessionError::Contradiction)?;
        let lesson = Lesson {
            name: record.name,
            plan: CheckedPlan::stored(record.plan, record.knees),
            seed: record.seed,
            students: record.students,
            order: record.order,
            current: record.trial - 1,
            began: record.began,
            torque_share: None,
            ended: record.ended,
            answers: record.answers,
            notes: record.notes,
        };
        Ok(Self {
            started: record.started,
            tool: record.tool,
            lesson,
            recordings: record.recordings,
        })
    }
}

impl Record {
    /// Checks that the parts fit each other.
    fn check(&self) -> Result<(), &'static str> {
        let trials = 1..=self.order.len();
        let answer_fits = |answer: &Answer| {
            trials.contains(&answer.trial)
                && (1..=5).contains(&answer.confidence)
                && answer
                    .torque_share
                    .is_none_or(|share| (0.0..=1.0).contains(&share))
                && self.students.contains(&answer.student)
        };
        let first = |at: usize, answer: &Answer| {
            let mut before = self.answers.iter().take(at);
            !before.any(|other| other.trial == answer.trial && other.student == answer.student)
        };
        if self.knees.len() != self.plan.knees.len() {
            Err("`knees` are not as many as those of the plan")
        } else if self.order.iter().any(|place| *place >= self.knees.len()) {
            Err("`order` names a knee that is not in the plan")
        } else if !trials.contains(&self.trial) {
            Err("`trial` is not one of the order")
        } else if !self.answers.iter().all(answer_fits) {
            Err("an answer has no such trial, student, confidence or share of torque")
        } else if !(0..)
            .zip(&self.answers)
            .all(|(at, answer)| first(at, answer))
        {
            Err("a student has two answers to one trial")
        } else if !self.recordings.iter().all(|r| trials.contains(&r.trial)) {
            Err("a recording has no such trial")
        } else {
            Ok(())
        }
    }
}

impl Started {
    /// A date and time of day; `None` if there is no such day or time.
    pub fn new(
        year: u16,
        month: u16,
        day: u16,
        hour: u16,
        minute: u16,
        second: u16,
    ) -> Option<Self> {
        let leap = year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
        let days = match month {
            2 if leap => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            1..=12 => 31,
            _ => return None,
        };
        let exists = (1..=days).contains(&day) && hour < 24 && minute < 60 && second < 60;
        let exists = exists && (1..=9999).contains(&year);
        exists.then_some(Self([year, month, day, hour, minute, second]))
    }

    /// The moment that many seconds after 1970-01-01 00:00:00, with the offset of the local time
    /// zone already added; UTC without. `None` beyond the year 9999.
    ///
    /// Days become a date of the Gregorian calendar in years that begin in March, so that the leap
    /// day is the last one of a year (Hinnant, *chrono-Compatible Low-Level Date Algorithms*).
    pub fn from_unix(seconds: u64) -> Option<Self> {
        let (days, second) = (seconds / 86_400, seconds % 86_400);
        // Days since 0000-03-01, in eras of 400 years.
        let days = days.checked_add(719_468)?;
        let (era, day) = (days / 146_097, days % 146_097);
        let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
        let day_of_year = day - (365 * year + year / 4 - year / 100);
        let month = (5 * day_of_year + 2) / 153;
        let day = day_of_year - (153 * month + 2) / 5 + 1;
        let month = if month < 10 { month + 3 } else { month - 9 };
        let year = era.checked_mul(400)? + year + u64::from(month <= 2);
        let small = |number: u64| u16::try_from(number).ok();
        Self::new(
            small(year)?,
            small(month)?,
            small(day)?,
            small(second / 3600)?,
            small(second / 60 % 60)?,
            small(second % 60)?,
        )
    }

    /// Form for a folder's name, which sorts by time: `2026-11-24-154205`.
    pub fn file_name(self) -> String {
        self.to_string().replace(' ', "-").replace(':', "")
    }
}

impl fmt::Display for Started {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [year, month, day, hour, minute, second] = self.0;
        write!(
            f,
            "{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}"
        )
    }
}

impl From<Started> for String {
    fn from(started: Started) -> Self {
        started.to_string()
    }
}

impl TryFrom<String> for Started {
    type Error = SessionError;

    fn try_from(text: String) -> Result<Self, SessionError> {
        let parsed = || {
            let (date, time) = text.split_once(' ')?;
            let numbers = date.splitn(3, '-').chain(time.splitn(3, ':'));
            let numbers: Option<Vec<u16>> = numbers.map(|number| number.parse().ok()).collect();
            let [year, month, day, hour, minute, second]: [u16; 6] = numbers?.try_into().ok()?;
            Self::new(year, month, day, hour, minute, second)
        };
        parsed().ok_or_else(|| SessionError::Date(text.clone()))
    }
}

#[cfg(test)]
mod tests;

//! Errors of a lesson.

use super::MOST_SEED;
use crate::lesson::plan::MOST_STUDENTS;
use crepitus_scene::preset::Level;
use crepitus_studies::experiment::finding::Finding;

/// Most characters of a pseudonym.
pub(super) const MOST_PSEUDONYM: usize = 20;

/// Most characters of a note.
pub(super) const MOST_NOTE: usize = 500;

/// Error of a lesson that cannot begin.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BeginError {
    /// Too many students, or none in a blind lesson.
    #[error(
        "{students} students; expected at most {MOST_STUDENTS}, and in a blind lesson at least 1: change the list of students"
    )]
    Students {
        /// Their number.
        students: usize,
    },
    /// An invalid pseudonym.
    #[error(
        "the pseudonym {pseudonym:?} is invalid; expected 1 to {MOST_PSEUDONYM} letters, digits, spaces, - and _, \
         with a letter or digit first and last"
    )]
    Pseudonym {
        /// The pseudonym.
        pseudonym: String,
    },
    /// Two students of one pseudonym.
    #[error("the pseudonym {pseudonym:?} occurs twice: give every student another one")]
    Duplicate {
        /// The pseudonym.
        pseudonym: String,
    },
    /// The seed is too large.
    #[error("the seed {seed} is too large; expected 0 to {MOST_SEED}")]
    Seed {
        /// The seed.
        seed: u64,
    },
}

/// Error of a request that does not fit the state of a lesson.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LessonError {
    /// The lesson has ended.
    #[error("the lesson has ended: begin another one")]
    Ended,
    /// The trial has not begun.
    #[error("trial {trial} has not begun: start it first")]
    NotBegun {
        /// Trial, from 1.
        trial: usize,
    },
    /// The trial has begun.
    #[error("trial {trial} has begun already: go on to the next one, or end the lesson")]
    Begun {
        /// Trial, from 1.
        trial: usize,
    },
    /// There is no next trial.
    #[error("trial {trial} is the last one: end the lesson")]
    LastTrial {
        /// Trial, from 1.
        trial: usize,
    },
    /// A student cannot be admitted.
    #[error(transparent)]
    Student(#[from] BeginError),
    /// Answer where the knee is shown: there is nothing to answer.
    #[error("this lesson is open, its knees are shown: answers belong to a blind lesson")]
    Open,
    /// The knee is revealed.
    #[error("the knee of trial {trial} is revealed: answers to it are closed")]
    Revealed {
        /// Trial, from 1.
        trial: usize,
    },
    /// No student of the lesson.
    #[error("there is no student {student:?} in this lesson; expected one of {}", .students.join(", "))]
    UnknownStudent {
        /// The pseudonym.
        student: String,
        /// Those there are.
        students: Vec<String>,
    },
    /// No disorder.
    #[error("there is no disorder {disorder:?}; expected one of {}", Finding::all().map(Finding::name).collect::<Vec<_>>().join(", "))]
    UnknownDisorder {
        /// The name.
        disorder: String,
    },
    /// No level.
    #[error("there is no level {level:?}; expected one of {}", Level::ALL.map(Level::name).join(", "))]
    UnknownLevel {
        /// The name.
        level: String,
    },
    /// No confidence.
    #[error("the confidence is {confidence}; expected 1 (a guess) to 5 (certain)")]
    Confidence {
        /// The number.
        confidence: u8,
    },
    /// No text.
    #[error("the note has {characters} characters; expected 1 to {MOST_NOTE}")]
    Note {
        /// Number of characters of the note.
        characters: usize,
    },
}

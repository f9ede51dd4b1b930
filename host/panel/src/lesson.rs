//! # Lessons
//!
//! ```text
//!  TOML, JSON of the page ─> Plan ─check─> CheckedPlan ─┐
//!  seed ─────────────────────────────────> order ───────┴─> Lesson ─> View   JSON of the page
//!                                    answers, notes ─────────> │
//!                                                              ├─> Summary  agreement: kappa, interval
//!                                                              └─> Session  folder: session.json, CSV, report.html
//! ```
//!
//! A lesson is a list of knees, examined one after another. In a *blind* lesson the students do
//! not see which knee it is: each names the disorder, its level and how confident he or she is,
//! and the lesson says afterwards how well the answers agree with the truth.
//!
//! [`Lesson`] is a state machine without input, output or clock: times are arguments. Only
//! [`SessionFolder`] touches the disk.
//!
//! | to find | look in |
//! |---|---|
//! | the form of a lesson's file, the shipped lessons | [`Plan`], [`plans`] |
//! | the order of the trials, from a seed | [`order`](crepitus_studies::experiment::order) |
//! | what may be called when; what is revealed when | [`Lesson`], [`LessonError`] |
//! | what a page shows, and a student's phone | [`View`], [`OwnView`] |
//! | Cohen's kappa and its interval | [`agreement`](crepitus_studies::experiment::agreement) |
//! | files of a session | [`SessionFolder`], [`Session`] |
//! | the page to print, and its texts | [`report`] |

mod folder;
mod lesson;
mod own;
mod plan;
pub mod plans;
pub mod report;
mod session;
mod summary;
mod view;

pub(crate) use crepitus_studies::experiment::finding::HEALTHY;
pub use crepitus_studies::experiment::finding::{Finding, Knee};
pub(crate) use folder::trial_of;
pub use folder::{FolderError, SessionFolder};
pub use lesson::{
    Answer, BeginError, By, LEAST_TORQUE_SHARE, Lesson, LessonError, MOST_SEED, Note,
};
pub(crate) use lesson::{check_pseudonym, is_same_name};
pub use own::{OwnAnswer, OwnView};
pub use plan::{
    CheckedPlan, Feedback, Known, MOST_STUDENTS, MOST_TRIALS, Plan, PlanError, PlannedKnee,
};
pub use session::{Recorded, Session, SessionError, Started};
pub use summary::{Confusion, Interval, Scores, StudentScores, Summary};
pub use view::{AnswerView, Choices, View};

//! # Studies
//!
//! Cost and robustness of solvers, measured over every rung of the ladder,
//! every convention and both precisions; influence and cost of each effect
//! of a scene.
//!
//! | to find | look in |
//! |---|---|
//! | what accuracy costs in time | [`accuracy`] |
//! | the hard cases, and their verdicts | [`stability`] |
//! | where the device stays quiet on a leg | [`coupled`] |
//! | what friction laws cost and how far they go | [`laws`] |
//! | influence of each effect on the torque at the hand, and its cost | [`effects`] |
//! | what the hand gets of the actuator on the shell | [`vibration`] |
//! | the other symptoms, stepped and by their reference | [`symptoms`] |
//! | a motion cut into steps | [`sampling`] |
//! | the true events, their matching, and the errors | [`true_events`], [`matching`], [`event_errors`] |
//! | limits parsed from text | [`limits`] |
//! | progress and cancellation of a study | [`watcher`] |
//! | pictures that explain one hard case, or a build-up, each | `story` |
//! | experiments with people: thresholds, A or B, realism | [`experiment`] |
//! | many runs of one scene, a row each | [`sweep`] |
//!
//! A study is one folder: its engine; `report`, how its data are drawn on its page; `words`, what is said of them on the
//! page and on a terminal. [`Outcome`] is the form that all of them have.

// Counts become numbers to be drawn or averaged; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

pub mod accuracy;
pub mod coupled;
pub mod effects;
pub mod event_errors;
pub mod experiment;
pub mod laws;
pub mod limits;
pub mod machine;
pub mod matching;
mod outcome;
mod parallel;
mod report_text;
pub mod sampling;
pub mod stability;
mod story;
pub mod sweep;
pub mod symptoms;
pub mod true_events;
pub mod vibration;
pub mod watcher;

pub use crepitus_pages::plot::page::Section;
pub use crepitus_pages::plot::{Column, Paper, Picture};
pub use outcome::Outcome;
pub use report_text::StudyText;
pub use watcher::{Cancelled, StudyError, Watcher};

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
//! | influence of each effect on the torque at the hand, and its cost | [`effects`] |
//! | what the hand gets of the actuator on the shell | [`vibration`] |
//! | the other symptoms, stepped and by their reference | [`symptoms`] |
//! | a motion cut into steps | [`sampling`] |
//! | the true events, their matching, and the errors | [`true_events`], [`matching`], [`event_errors`] |
//! | limits parsed from text | [`limits`] |
//! | progress and cancellation of a study | [`watcher`] |

pub mod accuracy;
pub mod coupled;
pub mod effects;
pub mod event_errors;
pub mod limits;
pub mod matching;
mod parallel;
mod random;
pub mod sampling;
pub mod stability;
pub mod symptoms;
pub mod true_events;
pub mod vibration;
pub mod watcher;

pub use watcher::{Cancelled, StudyError, Watcher};

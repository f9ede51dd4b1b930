//! # Studies
//!
//! What a solver costs and what it stands, measured over every rung of the
//! ladder, every convention and both precisions.
//!
//! | to find | look in |
//! |---|---|
//! | what accuracy costs in time | [`accuracy`] |
//! | the hard cases, and what holds in them | [`stability`] |
//! | a motion cut into steps | [`sampling`] |
//! | the true events, which belongs to which, and the errors | [`true_events`], [`matching`], [`event_errors`] |
//! | progress, and how a study ends early | [`watcher`] |

pub mod accuracy;
pub mod event_errors;
pub mod matching;
pub mod sampling;
pub mod stability;
pub mod true_events;
pub mod watcher;

pub use watcher::{StudyError, Watcher};

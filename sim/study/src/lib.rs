//! # Studies
//!
//! What a solver costs and what it stands, measured over every rung of the
//! ladder, every convention and both precisions; what each effect of a scene
//! does and costs.
//!
//! | to find | look in |
//! |---|---|
//! | what accuracy costs in time | [`accuracy`] |
//! | the hard cases, and what holds in them | [`stability`] |
//! | where the device stays quiet on a leg | [`coupled`] |
//! | what each effect does to the torque at the hand, and what it costs | [`effects`] |
//! | a motion cut into steps | [`sampling`] |
//! | the true events, which belongs to which, and the errors | [`true_events`], [`matching`], [`event_errors`] |
//! | limits as a text gives them | [`limits`] |
//! | progress, and how a study ends early | [`watcher`] |

pub mod accuracy;
pub mod coupled;
pub mod effects;
pub mod event_errors;
pub mod limits;
pub mod matching;
mod parallel;
pub mod sampling;
pub mod stability;
pub mod true_events;
pub mod watcher;

pub use watcher::{StudyError, Watcher};

//! The event-driven symptoms: shared cases, closed forms, hard cases, and a
//! plain integration of the laws.

mod any_symptom;
mod closed_muscles;
mod closed_plays;
mod hard_muscles;
mod hard_plays;
mod listed;
mod shared_cases;
mod stepped;
mod stepped_muscles;
mod stepped_plays;
mod support;
mod unshown;

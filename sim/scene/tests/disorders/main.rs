//! The event-driven symptoms: shared cases, closed forms, hard cases, and a
//! plain integration of the laws.

mod brute_force;
mod closed_forms;
mod hard_cases;
mod listed;
mod shared_cases;
mod support;

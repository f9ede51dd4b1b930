//! # Parameters of hardware, and of a measured knee, from recordings
//!
//! | what | from what | look in |
//! |---|---|---|
//! | the vibration actuator: resistance, resonance, force constant | voltage and current of its coil | [`actuator`] |
//! | the brace: friction, inertia, backlash, cuffs | a known weight that swings in it, as `crepitus record` writes it | [`brace`] |
//! | a model of a knee: symptom, grade, parameters | angle and torque of a passive examination | [`knee`] |
//! | the motor's torque constant | the current that moves a hanging weight slowly up and down | [`hanging`] |
//!
//! [`files`] reads what they take. All give values with 95 % intervals ([`Estimate`]), or a refusal that says what the
//! recording shows instead and what to do about it.
#![forbid(unsafe_code)]
// Counts become numbers; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

pub mod actuator;
pub mod brace;
mod descent;
mod estimate;
pub mod files;
pub mod hanging;
pub mod knee;
mod parallel;

pub use estimate::{DEVIATIONS, Estimate};

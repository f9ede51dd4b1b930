//! The laws of the symptoms as a device runs them, stepped at 20 kHz and kept over
//! commits: energy, mirror images, bad input, commits, gaps, and closed forms.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::panic,
    reason = "small numbers, and tests"
)]

#[path = "../support/mod.rs"]
mod support;

mod asperities;
mod closed;
mod decays;
mod gaps;
mod laws;
mod ledger;
mod mirror;
mod phases;
mod play;
mod random;
mod reset;
mod rig;
mod rules;
mod tank;
mod thresholds;

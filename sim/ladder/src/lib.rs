//! # What a step costs, wherever it runs
//!
//! Every rung of the solver ladder and every effect that runs on the device,
//! as subjects that are stepped from a block of memory. The same code runs on
//! the host and, as `firmware/ladder`, on the target: whoever emulates that
//! puts a plan into the block, and finds there what came of it.
//!
//! ```text
//!            ┌──────────── the exchange ────────────┐
//!  plan ───> │ command, state, entry │ plan │ steps │ <──> serve ──> a subject
//!  inputs ─> └──────────────────────────────────────┘         │
//!  outputs <──────────────── in place of the inputs ──────────┘
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | what is measured, and the names | [`subject`] |
//! | the words of the block | [`exchange`], [`plan`] |
//! | what one step of each is | [`measured`] |
//! | the program | [`mod@serve`] |
//! | what its steps have cost, in numbers | [`cost`] |
//!
//! A step is one call of one function that is never inlined. Its address is in
//! the block, so that whoever counts needs no symbols; what it costs to get the
//! inputs there and the outputs away is outside of it.
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing)
)]

#[cfg(test)]
extern crate std;

pub mod cost;
pub mod exchange;
pub mod measured;
pub mod plan;
pub mod serve;
pub mod subject;

pub use cost::{Call, Cost};
pub use exchange::Exchange;
pub use plan::Plan;
pub use serve::serve;
pub use subject::Subject;

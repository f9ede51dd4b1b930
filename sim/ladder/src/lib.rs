//! # Cost of a step, on host and target
//!
//! Every rung of the solver ladder, every effect that runs on the device and every
//! friction law,
//! as subjects that are stepped from a block of memory. The same code runs on
//! the host and, as `firmware/ladder`, on the target: its emulator writes a
//! plan into the block, and reads the results there.
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
//! | the subjects and their names | [`subject`] |
//! | the words of the block | [`exchange`], [`plan`] |
//! | one step of each subject | [`measured`] |
//! | the program | [`mod@serve`] |
//! | friction laws of others | [`laws`] |
//! | cost of its steps | [`cost`] |
//! | loops that are timed on the host | `loops` |
//! | many joints at once, on the host | `joints` |
//!
//! A step is one call of one function that is never inlined. Its address is in
//! the block, so that counting needs no symbols; copying inputs and outputs is
//! outside of it.
#![cfg_attr(not(feature = "joints"), no_std)]
#![cfg_attr(not(feature = "joints"), forbid(unsafe_code))]
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

#[cfg(feature = "loops")]
extern crate alloc;
#[cfg(all(test, not(feature = "joints")))]
extern crate std;

pub mod cost;
pub mod exchange;
#[cfg(feature = "joints")]
#[expect(
    clippy::indexing_slicing,
    reason = "never on the target; lanes and steps are numbered by their loops"
)]
pub mod joints;
pub mod laws;
#[cfg(feature = "loops")]
pub mod loops;
#[cfg(feature = "serve")]
pub mod measured;
pub mod plan;
#[cfg(feature = "serve")]
pub mod serve;
pub mod subject;

pub use cost::{Call, Cost};
pub use exchange::Exchange;
pub use plan::Plan;
#[cfg(feature = "serve")]
pub use serve::serve;
pub use subject::Subject;

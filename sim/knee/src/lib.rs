//! # A knee that a person moves
//!
//! The drive's torque on a leg that a hand drags by a spring, without hardware: natively, and as
//! WebAssembly in a page that needs nothing else.
//!
//! ```text
//! pointer ─> HandPath ── spring, damper ── Leg ── encoder counts ─> Pipeline ─> torque ─┐
//!            where the hand wants to be     └────────── resistance of the knee ─────────┘
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the hand: where it wants to be, and how hard it pulls | [`hand`] |
//! | the leg of a page | [`leg`] |
//! | the drive's torque from counts, and how its parameters change | [`pipeline`] |
//! | what an examination measures, its steps, and what was missed | [`examination`] |
//! | all of that together, a frame at a time | [`page`] |
//! | what a page calls | `page/exports.rs`, compiled for WebAssembly alone |
//!
//! No code here allocates, panics or loops without a bound. `crepitus-knee-page` of `crepitus-tools` builds
//! the page's file.
#![no_std]
#![deny(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]

#[cfg(test)]
extern crate std;

pub mod examination;
pub mod hand;
pub mod leg;
pub mod page;
pub mod pipeline;

pub use examination::Examination;
pub use hand::{Hand, HandPath, HandState};
pub use leg::Leg;
pub use page::Page;
pub use pipeline::Pipeline;

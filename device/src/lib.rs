//! # The logic of both controllers
//!
//! Hardware-independent: the firmware's tasks, the simulator and the tests all
//! run this code. Inputs of the peripherals, a tick, outputs to the peripherals.
//!
//! ```text
//!           USB                     link                      50 µs
//!  host ─────────> [`Comms`] ──────────────────> [`Drive`] ─────────> bridge
//!        requests   lease, commit,  heartbeats    safety,    torque
//!                   supervision     commands      model
//!       <─────────                <──────────────           <───────── encoder, current
//!        replies, blocks            status, blocks
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | what is wired to the controllers, with its values | [`board`] |
//! | the drive's tick: sample, render, command | [`drive`] |
//! | host requests, the lease, supervision of the drive | [`comms`] |
//! | the USB port of comms | [`usb_port`] |
//! | stored parameters | [`parameter_log`] |
//! | cycles of the hardware tasks | [`task_times`] |
//!
//! No code here allocates, panics, blocks or loops without a bound.
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::arithmetic_side_effects
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::arithmetic_side_effects
    )
)]

#[cfg(test)]
extern crate std;

pub mod board;
pub mod comms;
pub mod counters;
pub mod drive;
pub mod parameter_log;
pub mod self_test;
pub mod task_times;
pub mod usb_port;

pub use comms::Comms;
pub use drive::Drive;

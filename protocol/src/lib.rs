//! # The wires of Crepitus
//!
//! Every message between host, comms controller and drive controller stands
//! here, once; firmware, simulator, host and the book read it from here.
//!
//! ```text
//!        USB CDC                               UART, 4.2 Mbaud
//! host ───────────────────────> comms ───────────────────────────> drive
//!       Q  Request                     D  ToDrive (heartbeat, commit, command)
//!       M  Hello · Stop · Reboot       M  Hello · Stop · Reboot
//!      <───────────────────────       <───────────────────────────
//!       R  Reply                       S  FromDrive (status)
//!       T  Block of 20 samples         T  Block of 20 samples
//!       m  answers to M                m  answers to M
//! ```
//!
//! A frame is the same on both wires: a lane, a tag, a postcard message, a
//! CRC-32, COBS-encoded and ended by a zero byte. See [`frame`].
//!
//! | to find | look in |
//! |---|---|
//! | bytes to frames and back | [`frame`], [`decoder`] |
//! | what a frame carries | [`lane`] |
//! | messages of the host's wire | [`host`] |
//! | messages between the controllers | [`link`] |
//! | how a commit travels on the link | [`pieces`] |
//! | samples | [`telemetry`] |
//! | the lane that never changes: who is there, stop, reboot | [`management`] |
//! | whether two sides speak the same language | [`schema`] |
//! | parameters: id, name, unit, range, default, meaning | [`parameters`] |
//! | faults: code, cause, detector, reaction, time, how to clear | [`fault`] |
//! | counters | [`counters`] |
//! | by what a host finds a device | [`usb`] |
#![no_std]
#![forbid(unsafe_code)]
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

pub mod counters;
pub mod decoder;
pub mod fault;
pub mod frame;
pub mod host;
pub mod lane;
pub mod link;
pub mod management;
pub mod parameters;
pub mod pieces;
pub mod revision;
pub mod schema;
pub mod settings;
pub mod state;
pub mod telemetry;
pub mod usb;

pub use decoder::Decoder;
pub use fault::Fault;
pub use frame::Frame;
pub use lane::Lane;
pub use parameters::Values;
pub use revision::{Revision, Session};
pub use settings::{DeviceSettings, ValueError};
pub use state::{LimitReason, State};

/// Ticks of the drive in a second.
pub const TICKS_PER_S: u32 = 20_000;

/// Length of a tick of the drive, s.
pub const TICK_S: f64 = 5e-5;

/// After so many ticks without a fresh heartbeat the drive commands nothing.
pub const HEARTBEAT_TICKS: u64 = 101;

/// After so many ticks without a renewed lease the drive commands nothing.
pub const LEASE_TICKS: u64 = 5_001;

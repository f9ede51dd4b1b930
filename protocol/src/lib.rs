//! # The protocols of Crepitus
//!
//! All messages between host, comms controller and drive controller; firmware,
//! simulator, host and book use these definitions.
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
//! Both wires have the same frames: a lane, a version tag, a postcard message
//! and a CRC-32, COBS-encoded with a zero byte as delimiter. See [`frame`].
//!
//! | to find | look in |
//! |---|---|
//! | encoding and decoding of frames | [`frame`], [`decoder`] |
//! | kinds of frames | [`lane`] |
//! | messages between host and comms | [`host`] |
//! | messages between the controllers | [`link`] |
//! | fragmentation of a commit on the link | [`pieces`] |
//! | samples | [`telemetry`] |
//! | missing samples, and who counts them | [`accounting`] |
//! | the management lane, which never changes: hello, stop, reboot | [`management`] |
//! | schema hash: compatibility of two programs | [`schema`] |
//! | parameters: id, name, unit, range, default, meaning | [`parameters`] |
//! | faults: code, cause, detector, reaction, time, how to clear | [`fault`] |
//! | faults of the vibration actuator's coil | [`coil`] |
//! | counters | [`counters`] |
//! | cycles of the hardware tasks, stack | [`task_times`] |
//! | post-mortem record | [`crash`] |
//! | USB ids, to discover a device | [`usb`] |
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

pub mod accounting;
mod array;
mod checksum;
pub mod chirp;
pub mod coil;
pub mod counters;
pub mod crash;
pub mod decoder;
pub mod fault;
pub mod frame;
pub mod host;
pub mod lane;
pub mod link;
pub mod management;
pub mod measured;
pub mod parameters;
pub mod pieces;
#[cfg(test)]
mod reference;
pub mod revision;
pub mod schema;
pub mod settings;
pub mod state;
pub mod task_times;
pub mod telemetry;
pub mod usb;

pub use coil::CoilFault;
pub use crepitus_model::named;
pub use decoder::Decoder;
pub use fault::Fault;
pub use frame::Frame;
pub use lane::Lane;
pub use parameters::Values;
pub use revision::{Nonce, Revision, Session};
pub use settings::{DeviceSettings, ValueError};
pub use state::{LimitReason, State};

/// Ticks of the drive in a second.
pub const TICKS_PER_S: u32 = 20_000;

/// Length of a tick of the drive, µs.
pub const TICK_US: u32 = 50;

/// Length of a tick of the drive, s.
pub const TICK_S: f64 = 5e-5;

/// Timeout, ticks: without a fresh heartbeat for this long torque is off.
pub const HEARTBEAT_TICKS: u64 = 94;

/// Timeout, ticks: without a renewal of the lease for this long torque is off.
pub const LEASE_TICKS: u64 = 5_001;

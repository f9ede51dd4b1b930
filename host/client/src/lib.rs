//! # Client library for a device
//!
//! ```text
//!  tool, recorder, tests
//!        │ requests          ↑ events: blocks, states, lost connection
//!  ┌─────┴───────────────────┴─────────────────────────────────────┐
//!  │ [`Client`]   set · arm · subscribe · pump · reconnect         │ a device with the same schema
//!  │ [`Management`]   identify · stop · reboot                     │ a device of any version
//!  ├───────────────────────────────────────────────────────────────┤
//!  │ frames, sequence numbers, retries, lease, sample accounting   │
//!  └─────┬───────────────────↑─────────────────────────────────────┘
//!        │ bytes             │ bytes, and the clock
//!    [`Transport`]: [`Serial`], or a simulated device in this process
//! ```
//!
//! Single-threaded, without background work: the owner of a [`Client`] calls
//! [`Client::pump`] in a loop; it receives, renews the lease of an armed device,
//! and returns events. The transport is the clock, so a simulated device may run
//! faster than real time, and tests are deterministic.
//!
//! **Requests are idempotent.** After a timeout a request is sent again with the
//! same sequence number; the device repeats its reply and does not execute it
//! again.
//!
//! ```no_run
//! use crepitus_client::{Client, Error, Event, Serial};
//! use std::time::Duration;
//!
//! # fn main() -> Result<(), Error> {
//! let mut client = Client::connect(Serial::open("/dev/ttyACM0")?)?;
//! client.set(&[(crepitus_protocol::parameters::id::STATIC_TORQUE, 0.5)])?;
//! client.subscribe()?;
//! while let Some(event) = client.pump(Duration::from_millis(20))? {
//!     if let Event::Block(arrival) = event {
//!         println!("{} {}", arrival.block.first_tick, arrival.missing);
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the device that a name means: attached, served, simulated, emulated | [`connection`] |
//! | one device for several programs | [`sharing`] |
//! | discovery of devices | [`discovery`] |
//! | a port: its holder, errors of opening | [`Serial`], [`TransportError`] |
//! | errors, with remedies | [`Error`], [`Refused`], [`Mismatch`], [`fault_text`], [`coil_fault_text`] |
//! | accounting of received and lost samples | [`Accounting`] |
//! | parameters as text | [`values`] |
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod accounting;
mod client;
pub mod connection;
pub mod discovery;
mod errors;
mod event;
mod exchange;
mod faults;
mod handshake;
mod loss;
mod management;
mod pump;
mod reconnect;
mod refusals;
mod request_kind;
mod requests;
mod round_trips;
mod serial;
mod session;
pub mod sharing;
mod transport;
pub mod values;
mod wire;

pub use accounting::{Accounting, Gap};
pub use client::{Client, Tally, Unheard};
pub use crepitus_protocol::accounting::Begin;
pub use errors::{Conflict, Error};
pub use event::{Arrival, Event, StateChange};
pub use faults::{coil_fault_text, fault_text};
pub use handshake::{Handshake, Mismatch, TOOL_VERSION, Version};
pub use management::Management;
pub use reconnect::{Reconnected, Resubscribed};
pub use refusals::Refused;
pub use request_kind::RequestKind;
pub use requests::Crash;
pub use round_trips::{RoundTrip, RoundTrips};
pub use serial::{Serial, holder_of};
pub use session::Options;
pub use transport::{Holder, Transport, TransportError};

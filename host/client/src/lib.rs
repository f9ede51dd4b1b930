//! # Talks to a device
//!
//! ```text
//!  tool, recorder, tests
//!        │ requests          ↑ events: blocks, states, a lost line
//!  ┌─────┴───────────────────┴─────────────────────────────────────┐
//!  │ [`Client`]   set · arm · subscribe · pump · reconnect         │ a device of the same language
//!  │ [`Management`]   identify · stop · reboot                     │ a device of any version
//!  ├───────────────────────────────────────────────────────────────┤
//!  │ frames, numbers, repeats, the lease, the books of telemetry   │
//!  └─────┬───────────────────↑─────────────────────────────────────┘
//!        │ bytes             │ bytes, and the clock
//!    [`Transport`]: [`Serial`], or a simulated device in this process
//! ```
//!
//! One thread, and nothing happens between calls: whoever has a [`Client`]
//! calls [`Client::pump`] again and again; that receives, renews the lease of
//! an armed device, and hands out what has happened. Time is that of the
//! transport, so a simulated device may run faster than the wall, and a test
//! that is repeated does the same again.
//!
//! **Every request may be repeated.** A request that has no reply in time is
//! sent again with its number; the device answers again and does not carry it
//! out again.
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
//! | which devices there are | [`discovery`] |
//! | a port: who has it, why it does not open | [`Serial`], [`TransportError`] |
//! | what may go wrong, said so that a person can mend it | [`Error`], [`Refused`], [`Mismatch`], [`fault_text`] |
//! | what of the telemetry arrived | [`Accounting`] |
//! | parameters as text | [`values`] |
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod accounting;
mod asking;
mod client;
pub mod discovery;
mod errors;
mod event;
mod faults;
mod handshake;
mod management;
mod pump;
mod reconnect;
mod refusals;
mod request_kind;
mod requests;
mod round_trips;
mod serial;
mod session;
mod transport;
pub mod values;
mod wire;

pub use accounting::{Accounting, Gap, Taken};
pub use client::{Client, Tally};
pub use errors::{Conflict, Error};
pub use event::{Arrival, Event, StateChange};
pub use faults::fault_text;
pub use handshake::{Handshake, Mismatch, TOOL_VERSION, Version};
pub use management::Management;
pub use reconnect::{Reconnected, Resubscribed};
pub use refusals::Refused;
pub use request_kind::RequestKind;
pub use round_trips::{RoundTrip, RoundTrips};
pub use serial::Serial;
pub use session::Options;
pub use transport::{Holder, Transport, TransportError};

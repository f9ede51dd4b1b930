//! USB/IP: the simulated device on another computer's USB bus, with that system's own drivers.
//!
//! ```text
//!   /dev/ttyACM0 ── cdc_acm ── vhci_hcd ══ TCP ══ [`Server`] ── transactions ── device
//!         the importer's kernel                  host controller
//! ```
//! The server is the host controller and the hub of a machine that has this one device: it resets
//! the bus and gives an address. The importer's kernel does all the rest of an enumeration, and its
//! drivers move the data; the descriptors are the device's own.
//!
//! Protocol 1.1.1, as in the Linux kernel's `Documentation/usb/usbip_protocol.rst`:
//! - [`messages`]: the bytes, and what is refused before any memory is spent on it;
//! - `urbs`: requests of a host's driver as transactions, one for each endpoint in a turn;
//! - `exported`: what the device says of itself;
//! - `connection`: a socket that never blocks, with bounded buffers;
//! - [`server`]: who is connected, who has the device.
//!
//! **Supported**: control, bulk and interrupt transfers, several pending for each endpoint; short
//! and zero-length packets (`URB_ZERO_PACKET`, `URB_SHORT_NOT_OK`), stalls, unlinking, and a device
//! that disconnects.
//!
//! **Not supported**: isochronous transfers, other speeds than full speed, more than one device,
//! resets of the port by the importer (Linux does not send them), and any authentication: the
//! protocol has none. Any program that can reach the port can use the device.

mod connection;
mod exported;
pub mod messages;
pub mod server;
mod urbs;

pub use server::{Event, Server};

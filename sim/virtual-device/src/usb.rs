//! A software USB bus: the genuine device stack below, a host that enumerates it above.
//!
//! ```text
//!   any serial program      this program's own client      a driver of Linux
//!        │ /dev/pts/N                 │                       ║ TCP
//!     [`pty`]                         │                       ║
//!        └───────────┬────────────────┘                       ║
//!             [`host`]  bytes ⇄ packets, frames of 1 ms    [`usbip`]  URBs
//!                    │                                        │
//!   [`enumeration`] · [`control`] · [`descriptors`] · [`configuration`]
//!                         │
//! ── [`wire`] ────────────┼──────── one call = one transaction ─────────
//!                         │
//!         ┌───────────────┴───────────────┐
//!   [`cable`] ═ [`bus`]             an emulated USB core
//!   usb-device, usbd-serial,      with the firmware's image on it
//!   the device's own port
//! ```
//!
//! **Real**: the device stack and the serial class, the device's own port, every request of an
//! enumeration, packets, short and zero-length packets, NAKs, stalls, bus resets, suspend,
//! the bandwidth of a full-speed bus, and a pulled cable.
//!
//! **Virtual**: the peripheral and its registers, the host's driver, and time. The device makes
//! progress only when the caller lets it run, in turns of 50 µs; nothing here blocks, sleeps or
//! reads a clock, so a run is deterministic, as fast as the machine can. (What a program at a pty or a
//! client over TCP does when is not.)
//!
//! **Not modelled**: bit errors with their retries and data toggles, the bus time of a NAK,
//! hubs and a second device, high speed, isochronous transfers, remote wake-up. The host here does
//! not poll the interrupt endpoint (the serial class has nothing to notify), a driver over USB/IP does.
//! A pty carries bytes, not line coding or DTR.
//!
//! ```
//! use crepitus_device::usb_port::{HostBytes, UsbIdentity, UsbPort};
//! use crepitus_virtual_device::usb::{bus::SoftBus, host::CdcHost};
//! use usb_device::bus::UsbBusAllocator;
//!
//! struct Greeting(&'static [u8]);
//! impl HostBytes for Greeting {
//!     fn received(&mut self, _: &[u8]) {}
//!     fn to_send(&self) -> &[u8] { self.0 }
//!     fn sent(&mut self, count: usize) { self.0 = &self.0[count..] }
//!     fn host_lost(&mut self) {}
//! }
//!
//! let (bus, mut cable) = SoftBus::new();
//! let allocator = UsbBusAllocator::new(bus);
//! let identity = UsbIdentity { manufacturer: "m", product: "p", serial_number: "1" };
//! let mut port = UsbPort::new(&allocator, &identity).unwrap();
//! let mut end = Greeting(b"hello");
//! let mut run = |_: &mut _| port.poll(&mut end);
//! let mut host = CdcHost::enumerate(&mut cable, &mut run).unwrap();
//! host.frame(&mut cable, &mut run).unwrap();
//! assert_eq!(host.read_all(), b"hello");
//! ```

pub mod bus;
pub mod cable;
pub mod cabled;
pub mod configuration;
pub mod control;
pub mod descriptors;
mod endpoint;
pub mod enumeration;
mod frame_time;
pub mod host;
mod peripheral;
#[cfg(unix)]
pub mod pty;
pub mod usbip;
pub mod wire;

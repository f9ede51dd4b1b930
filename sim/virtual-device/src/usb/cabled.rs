//! A device at the end of a host's cable, in virtual time.

use crate::usb::host::CdcHost;
use crate::usb::usbip::{Event, Server};
use std::error::Error;

/// A simulated or emulated device with its leg, and the host's end of its cable.
pub trait CabledDevice: Send {
    /// 50 µs of everything. A device that does not answer is disconnected until
    /// it is plugged in again.
    fn tick(&mut self);

    /// Ticks since it was switched on.
    fn now(&self) -> u64;

    /// Plugs the device in, and enumerates it.
    ///
    /// # Errors
    /// The reason, if that fails: its controller hangs, or is just starting.
    fn plug_in(&mut self) -> Result<(), Box<dyn Error + Send + Sync>>;

    /// The host's end of the cable, if the device is plugged in.
    fn host(&mut self) -> Option<&mut CdcHost>;

    /// Lets a server have the cable for a frame, instead of [`host`](Self::host), which gives it up;
    /// returns what has happened.
    fn serve(&mut self, server: &mut Server) -> Vec<Event>;
}

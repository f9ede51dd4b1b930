//! The wire between a host and a device, at the level of transactions.
//!
//! A host calls, a device answers; one call is one transaction of USB 2.0 chapter 8 (token, data,
//! handshake). Everything above this interface is a host, everything below it a device: a
//! [`SoftBus`](crate::usb::bus::SoftBus), or an emulated USB core.
//!
//! There is no time here. After [`Handshake::Nak`] the owner of the simulation lets
//! the device run and retries.
//!
//! Not modelled: bit errors, and therefore time-outs, retries and data toggles.

use core::fmt;
use core::ops::Deref;

/// The largest packet of a full-speed bulk or control endpoint, bytes.
pub const MAX_PACKET: usize = 64;

/// The data of one transaction: at most [`MAX_PACKET`] bytes, possibly none.
#[derive(Clone, Copy)]
pub struct Packet {
    bytes: [u8; MAX_PACKET],
    length: usize,
}

impl Packet {
    /// The zero-length packet.
    pub const EMPTY: Self = Self {
        bytes: [0; MAX_PACKET],
        length: 0,
    };

    /// A packet of these bytes, or `None` if there are more than [`MAX_PACKET`].
    pub fn new(data: &[u8]) -> Option<Self> {
        let mut packet = Self::EMPTY;
        packet.bytes.get_mut(..data.len())?.copy_from_slice(data);
        packet.length = data.len();
        Some(packet)
    }
}

impl Deref for Packet {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

impl fmt::Debug for Packet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl PartialEq for Packet {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl Eq for Packet {}

/// Address of a transaction. The direction is in the kind of transaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// The device's address, 0 until it is given one.
    pub address: u8,
    /// The endpoint's number, 0 to 15.
    pub endpoint: u8,
}

/// Answer of a device to a transaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Handshake {
    /// Done; with the data for an IN transaction, empty for the others.
    Ack(Packet),
    /// Not now: no data ready, or no room.
    Nak,
    /// The endpoint is halted, or the control request is refused.
    Stall,
    /// No answer: no device, another address, no such endpoint, or a device in reset.
    Absent,
}

/// The device end of the wire, as a host sees it.
pub trait UsbWire {
    /// The host holds the bus in reset long enough for every device to notice.
    fn bus_reset(&mut self);

    /// A SETUP transaction: the eight bytes of a control request. A device that is there cannot
    /// refuse it.
    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake;

    /// An OUT transaction: one packet from the host to the device.
    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake;

    /// An IN transaction: one packet from the device to the host.
    fn in_transaction(&mut self, token: Token) -> Handshake;

    /// The host stops the frames on this port, as when it goes to sleep or lets the device go. A
    /// device sees an idle bus, which is a suspend, until the next [`bus_reset`](Self::bus_reset).
    ///
    /// On a wire that does not model frames this does nothing.
    fn suspend(&mut self) {}

    /// Returns whether a hub reports a device on this port: the cable is plugged in and the device has
    /// its pull-up on.
    ///
    /// On a wire that does not model the pull-up a device is always there; one that is gone
    /// answers [`Handshake::Absent`].
    fn is_connected(&self) -> bool {
        true
    }
}

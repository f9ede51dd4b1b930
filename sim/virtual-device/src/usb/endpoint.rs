//! The endpoints of the software bus: state of a full-speed device's endpoint hardware.
//!
//! Each endpoint and direction has one packet buffer, as in the peripherals the firmware uses.
//! Both ends access it: the host's transactions and the device stack.

use crate::usb::wire::{Handshake, Packet};
use usb_device::{Result, UsbError};

/// Count of a device's endpoint numbers in each direction.
pub(crate) const ENDPOINTS: usize = 16;

/// An endpoint that sends to the host.
#[derive(Clone, Debug, Default)]
pub(crate) struct InEndpoint {
    /// Largest packet, bytes; `None` until the device stack allocates the endpoint.
    pub(crate) max_packet: Option<usize>,
    /// Waiting for the host to fetch it.
    pub(crate) packet: Option<Packet>,
    /// A packet has been fetched; not yet reported to the device stack.
    pub(crate) complete: bool,
    pub(crate) stalled: bool,
}

impl InEndpoint {
    /// Restores the state after a bus reset.
    pub(crate) fn reset(&mut self) {
        self.abandon();
        self.complete = false;
    }

    /// Drops the packet and ends the stall. What has been fetched stays fetched.
    pub(crate) fn abandon(&mut self) {
        self.packet = None;
        self.stalled = false;
    }

    /// The device hands over a packet.
    pub(crate) fn write(&mut self, data: &[u8]) -> Result<usize> {
        let max_packet = self.max_packet.ok_or(UsbError::InvalidEndpoint)?;
        if self.packet.is_some() {
            return Err(UsbError::WouldBlock);
        }
        if data.len() > max_packet {
            return Err(UsbError::BufferOverflow);
        }
        self.packet = Some(Packet::new(data).ok_or(UsbError::BufferOverflow)?);
        Ok(data.len())
    }

    /// The host fetches a packet. A halt hides the packet but keeps it.
    pub(crate) fn transact(&mut self) -> Handshake {
        if self.max_packet.is_none() {
            return Handshake::Absent;
        }
        if self.stalled {
            return Handshake::Stall;
        }
        match self.packet.take() {
            None => Handshake::Nak,
            Some(packet) => {
                self.complete = true;
                Handshake::Ack(packet)
            }
        }
    }
}

/// An endpoint that receives from the host.
#[derive(Clone, Debug, Default)]
pub(crate) struct OutEndpoint {
    /// Largest packet, bytes; `None` until the device stack allocates the endpoint.
    pub(crate) max_packet: Option<usize>,
    /// Waiting for the device stack to read it.
    pub(crate) packet: Option<Packet>,
    pub(crate) stalled: bool,
}

impl OutEndpoint {
    /// Drops the packet and ends the stall: the state after a bus reset.
    pub(crate) fn abandon(&mut self) {
        self.packet = None;
        self.stalled = false;
    }

    /// The device takes the packet. One that does not fit is lost: the next can come.
    pub(crate) fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if self.max_packet.is_none() {
            return Err(UsbError::InvalidEndpoint);
        }
        let packet = self.packet.take().ok_or(UsbError::WouldBlock)?;
        buffer
            .get_mut(..packet.len())
            .ok_or(UsbError::BufferOverflow)?
            .copy_from_slice(&packet);
        Ok(packet.len())
    }

    /// The host sends a packet. One that is longer than the endpoint's largest gets no answer.
    pub(crate) fn transact(&mut self, data: &[u8]) -> Handshake {
        let Some(packet) = self
            .max_packet
            .filter(|&max_packet| data.len() <= max_packet)
            .and_then(|_| Packet::new(data))
        else {
            return Handshake::Absent;
        };
        if self.stalled {
            return Handshake::Stall;
        }
        if self.packet.is_some() {
            return Handshake::Nak;
        }
        self.packet = Some(packet);
        Handshake::Ack(Packet::EMPTY)
    }
}

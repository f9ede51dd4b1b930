//! Control transfers: the three stages of USB 2.0 section 5.5, from the host's side.

use crate::usb::wire::{Handshake, Packet, Token, UsbWire};

/// One turn of the device is a twentieth of a frame, 50 µs: what the caller's `run` lets pass.
pub const TURNS_PER_FRAME: u32 = 20;

/// A device answers a control request within 500 ms (USB 2.0, 9.2.6.4).
const TIMEOUT_TURNS: u32 = 500 * TURNS_PER_FRAME;

/// The eight bytes of a SETUP packet, without the length of the data stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControlRequest {
    /// `bmRequestType`: direction, type and recipient.
    pub request_type: u8,
    /// `bRequest`.
    pub request: u8,
    /// `wValue`.
    pub value: u16,
    /// `wIndex`.
    pub index: u16,
}

impl ControlRequest {
    fn to_bytes(self, length: u16) -> [u8; 8] {
        let [value_low, value_high] = self.value.to_le_bytes();
        let [index_low, index_high] = self.index.to_le_bytes();
        let [length_low, length_high] = length.to_le_bytes();
        [
            self.request_type,
            self.request,
            value_low,
            value_high,
            index_low,
            index_high,
            length_low,
            length_high,
        ]
    }
}

/// Reason why a transfer did not complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TransferError {
    /// The device refuses: a request it does not know, or a halted endpoint.
    #[error("the device stalled endpoint {endpoint}")]
    Stalled {
        /// The endpoint's number.
        endpoint: u8,
    },
    /// The device does not answer.
    #[error("the device does not answer")]
    Detached,
    /// The device answered NAK for longer than the standard allows.
    #[error("the device is not ready after {turns} turns of 50 µs")]
    TimedOut {
        /// Turns of the device so far.
        turns: u32,
    },
    /// The data stage of a control transfer is at most 65,535 bytes.
    #[error("{bytes} bytes do not fit a control transfer")]
    TooLong {
        /// Bytes to send.
        bytes: usize,
    },
    /// The device sent more than was asked for.
    #[error("the device sent {received} bytes where {requested} were requested")]
    Overrun {
        /// Bytes received.
        received: usize,
        /// Bytes requested.
        requested: u16,
    },
}

/// The control endpoint of one device.
///
/// `run` lets the device run for one turn; it is called whenever the device is not ready.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControlPipe {
    /// The device's address.
    pub address: u8,
    /// `bMaxPacketSize0`: 8, 16, 32 or 64 bytes.
    pub max_packet: u8,
}

impl ControlPipe {
    /// A request with data from the device: at most `length` bytes, or fewer.
    pub fn read<W: UsbWire>(
        self,
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
        request: ControlRequest,
        length: u16,
    ) -> Result<Vec<u8>, TransferError> {
        let token = self.token();
        let setup = request.to_bytes(length);
        persist(wire, run, |wire| wire.setup_transaction(token, setup))?;
        let mut data = Vec::new();
        while data.len() < usize::from(length) {
            let packet = persist(wire, run, |wire| wire.in_transaction(token))?;
            data.extend_from_slice(&packet);
            if packet.len() < usize::from(self.max_packet) {
                break;
            }
        }
        if data.len() > usize::from(length) {
            return Err(TransferError::Overrun {
                received: data.len(),
                requested: length,
            });
        }
        persist(wire, run, |wire| wire.out_transaction(token, &[]))?;
        Ok(data)
    }

    /// A request with data to the device, or without data.
    pub fn write<W: UsbWire>(
        self,
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
        request: ControlRequest,
        data: &[u8],
    ) -> Result<(), TransferError> {
        let token = self.token();
        let length =
            u16::try_from(data.len()).map_err(|_| TransferError::TooLong { bytes: data.len() })?;
        let setup = request.to_bytes(length);
        persist(wire, run, |wire| wire.setup_transaction(token, setup))?;
        for packet in data.chunks(usize::from(self.max_packet.max(1))) {
            persist(wire, run, |wire| wire.out_transaction(token, packet))?;
        }
        persist(wire, run, |wire| wire.in_transaction(token))?;
        Ok(())
    }

    fn token(self) -> Token {
        Token {
            address: self.address,
            endpoint: 0,
        }
    }
}

/// Repeats a transaction until the device is ready for it.
fn persist<W: UsbWire>(
    wire: &mut W,
    run: &mut impl FnMut(&mut W),
    mut transaction: impl FnMut(&mut W) -> Handshake,
) -> Result<Packet, TransferError> {
    for _ in 0..TIMEOUT_TURNS {
        match transaction(wire) {
            Handshake::Ack(packet) => return Ok(packet),
            Handshake::Nak => run(wire),
            Handshake::Stall => return Err(TransferError::Stalled { endpoint: 0 }),
            Handshake::Absent => return Err(TransferError::Detached),
        }
    }
    Err(TransferError::TimedOut {
        turns: TIMEOUT_TURNS,
    })
}

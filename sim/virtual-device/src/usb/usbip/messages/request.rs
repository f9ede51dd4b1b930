//! Messages of a client. Any bytes are a request, the beginning of one, or a [`MessageError`].
//!
//! Decoding takes no memory but for the data of a transfer, at most [`MAX_TRANSFER`] bytes.
//! `Ok(None)` means that more bytes have to come.

use super::{BUS_ID_LENGTH, HEADER_LENGTH, MAX_TRANSFER, VERSION};

/// The length of a request before an import, without what follows, bytes.
const OPERATION_LENGTH: usize = 8;

const OP_REQ_DEVLIST: u16 = 0x8005;
const OP_REQ_IMPORT: u16 = 0x8003;
const CMD_SUBMIT: u32 = 1;
const CMD_UNLINK: u32 = 2;

/// The number of packets in a transfer that is not isochronous: as documented, and as Linux sends it.
const NOT_ISOCHRONOUS: [u32; 2] = [u32::MAX, 0];

/// A message that this server does not accept. The connection cannot continue: the start of the next
/// message is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MessageError {
    /// Another version of the protocol, or no USB/IP at all.
    #[error(
        "expected USB/IP version {:#06x} (1.1.1), got {found:#06x}: update the client, or it does not speak USB/IP",
        VERSION
    )]
    Version {
        /// The version in the message.
        found: u16,
    },
    /// A request that is neither a list of devices nor an import.
    #[error("expected OP_REQ_DEVLIST (0x8005) or OP_REQ_IMPORT (0x8003), got {code:#06x}")]
    UnknownOperation {
        /// The code in the message.
        code: u16,
    },
    /// A command that is neither `CMD_SUBMIT` nor `CMD_UNLINK`.
    #[error("expected CMD_SUBMIT (1) or CMD_UNLINK (2), got command {command:#x}")]
    UnknownCommand {
        /// The command in the message.
        command: u32,
    },
    /// A command for another device than the one imported.
    #[error("a command for device {found:#010x}, but {imported:#010x} is imported")]
    OtherDevice {
        /// The device of this connection: bus number · 65,536 + device number.
        imported: u32,
        /// The device in the message.
        found: u32,
    },
    /// A direction that is neither OUT nor IN.
    #[error("expected direction 0 (OUT) or 1 (IN), got {direction}")]
    Direction {
        /// The direction in the message.
        direction: u32,
    },
    /// An endpoint's number that does not exist.
    #[error("expected an endpoint from 0 to 15, got {endpoint}")]
    Endpoint {
        /// The endpoint in the message.
        endpoint: u32,
    },
    /// A transfer longer than [`MAX_TRANSFER`].
    #[error("a transfer of {bytes} bytes; at most {MAX_TRANSFER} are accepted")]
    TooLong {
        /// Length of the transfer, bytes.
        bytes: u32,
    },
    /// An isochronous transfer.
    #[error("a transfer of {packets} isochronous packets; isochronous transfers are not supported")]
    Isochronous {
        /// The number of packets in the message.
        packets: u32,
    },
}

/// Request of a client that does not have a device yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// The devices that can be imported.
    ListDevices,
    /// The device of this bus id.
    Import {
        /// The bus id, filled up with zero bytes.
        bus_id: [u8; BUS_ID_LENGTH],
    },
}

impl Operation {
    /// Reads one request from the front of these bytes, with its length.
    ///
    /// # Errors
    ///
    /// [`MessageError::Version`] or [`MessageError::UnknownOperation`].
    pub fn decode(bytes: &[u8]) -> Result<Option<(Self, usize)>, MessageError> {
        let mut fields = Fields(bytes);
        // A wrong version is an error as soon as it is there: who speaks something else may never
        // send eight bytes.
        let Some(found) = fields.u16() else {
            return Ok(None);
        };
        if found != VERSION {
            return Err(MessageError::Version { found });
        }
        let Some(code) = fields.u16() else {
            return Ok(None);
        };
        if ![OP_REQ_DEVLIST, OP_REQ_IMPORT].contains(&code) {
            return Err(MessageError::UnknownOperation { code });
        }
        // The status has no meaning in a request.
        let Some(_status) = fields.u32() else {
            return Ok(None);
        };
        if code == OP_REQ_DEVLIST {
            return Ok(Some((Self::ListDevices, OPERATION_LENGTH)));
        }
        let length = OPERATION_LENGTH + BUS_ID_LENGTH;
        Ok(fields
            .bytes()
            .map(|bus_id| (Self::Import { bus_id }, length)))
    }
}

/// Direction of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the device.
    Out,
    /// From the device.
    In,
}

/// A transfer to be done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Submit {
    /// Number of the transfer, which the reply carries.
    pub sequence: u32,
    /// Direction of the transfer.
    pub direction: Direction,
    /// The endpoint's number, 0 to 15.
    pub endpoint: u8,
    /// `URB_...` of Linux.
    pub flags: u32,
    /// The length of the buffer, bytes: at most [`MAX_TRANSFER`].
    pub length: usize,
    /// The number of packets as the client gave it, which the reply repeats: 0 or −1.
    pub packets: u32,
    /// The SETUP packet of a control transfer.
    pub setup: [u8; 8],
    /// The data of an OUT transfer: `length` bytes.
    pub data: Vec<u8>,
}

/// Command of a client that has a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Command {
    /// Do a transfer.
    Submit(Submit),
    /// Withdraw a transfer.
    Unlink {
        /// The number of this command, which the reply carries.
        sequence: u32,
        /// The number of the transfer.
        victim: u32,
    },
}

impl Command {
    /// Reads one command for this device from the front of these bytes, with its length.
    ///
    /// # Errors
    ///
    /// A header that is invalid or not accepted, as soon as the header is there.
    pub fn decode(bytes: &[u8], imported: u32) -> Result<Option<(Self, usize)>, MessageError> {
        let Some((header, data)) = bytes.split_first_chunk::<HEADER_LENGTH>() else {
            return Ok(None);
        };
        let word = |index: usize| -> u32 {
            let mut fields = Fields(header.get(4 * index..).unwrap_or_default());
            fields.u32().unwrap_or_default()
        };
        let (command, sequence, found) = (word(0), word(1), word(2));
        if ![CMD_SUBMIT, CMD_UNLINK].contains(&command) {
            return Err(MessageError::UnknownCommand { command });
        }
        if found != imported {
            return Err(MessageError::OtherDevice { imported, found });
        }
        if command == CMD_UNLINK {
            let victim = word(5);
            return Ok(Some((Self::Unlink { sequence, victim }, HEADER_LENGTH)));
        }
        let direction = match word(3) {
            0 => Direction::Out,
            1 => Direction::In,
            direction => return Err(MessageError::Direction { direction }),
        };
        let Ok(endpoint @ 0..=15) = u8::try_from(word(4)) else {
            return Err(MessageError::Endpoint { endpoint: word(4) });
        };
        let packets = word(8);
        if !NOT_ISOCHRONOUS.contains(&packets) {
            return Err(MessageError::Isochronous { packets });
        }
        let length = match usize::try_from(word(6)) {
            Ok(length) if length <= MAX_TRANSFER => length,
            _ => return Err(MessageError::TooLong { bytes: word(6) }),
        };
        let carried = match direction {
            Direction::Out => length,
            Direction::In => 0,
        };
        let Some(data) = data.get(..carried) else {
            return Ok(None);
        };
        let mut setup = Fields(header.get(40..).unwrap_or_default());
        let submit = Submit {
            sequence,
            direction,
            endpoint,
            flags: word(5),
            length,
            packets,
            setup: setup.bytes().unwrap_or_default(),
            data: data.to_vec(),
        };
        Ok(Some((Self::Submit(submit), HEADER_LENGTH + carried)))
    }
}

/// Big-endian fields from the front of a message.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (field, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*field)
    }

    fn u16(&mut self) -> Option<u16> {
        self.bytes().map(u16::from_be_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_be_bytes)
    }
}

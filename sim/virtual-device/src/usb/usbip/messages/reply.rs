//! Messages of the server.

use super::{BUS_ID_LENGTH, HEADER_LENGTH, VERSION};

/// The length of the path in a device's record, bytes: text that ends with a zero byte.
const PATH_LENGTH: usize = 256;

/// The most interfaces that a record can name.
const MOST_INTERFACES: usize = 255;

const OP_REP_DEVLIST: u16 = 0x0005;
const OP_REP_IMPORT: u16 = 0x0003;
const RET_SUBMIT: u32 = 3;
const RET_UNLINK: u32 = 4;

/// Reason why a request before an import is refused, in its reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Refusal {
    /// Another client has the device (`ST_DEV_BUSY`).
    Busy = 2,
    /// The device does not answer (`ST_DEV_ERR`).
    DeviceError = 3,
    /// There is no device of this bus id (`ST_NODEV`).
    NoDevice = 4,
}

/// A device as a client sees it before it imports it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceRecord {
    /// Path of the device on the server, for people: at most 255 bytes.
    pub path: &'static str,
    /// Name of the device in requests: at most 31 bytes.
    pub bus_id: &'static str,
    /// The number of its bus.
    pub bus: u16,
    /// Number of the device on that bus.
    pub number: u16,
    /// `idVendor`.
    pub vendor_id: u16,
    /// `idProduct`.
    pub product_id: u16,
    /// `bcdDevice`.
    pub release: u16,
    /// `bDeviceClass`, `bDeviceSubClass`, `bDeviceProtocol`.
    pub class: [u8; 3],
    /// `bConfigurationValue` of the configuration in force, 0 for none.
    pub configuration: u8,
    /// `bNumConfigurations`.
    pub configurations: u8,
    /// Class, subclass and protocol of each interface.
    pub interfaces: Vec<[u8; 3]>,
}

impl DeviceRecord {
    /// `USB_SPEED_FULL` of Linux: 12 Mbit/s.
    const FULL_SPEED: u32 = 2;

    /// The number that commands for this device carry.
    pub fn device_id(&self) -> u32 {
        u32::from(self.bus) << 16 | u32::from(self.number)
    }

    /// The interfaces, as many as one byte can count.
    fn named_interfaces(&self) -> &[[u8; 3]] {
        let count = self.interfaces.len().min(MOST_INTERFACES);
        &self.interfaces[..count]
    }

    fn append_to(&self, message: &mut Vec<u8>) {
        append_text(message, self.path, PATH_LENGTH);
        append_text(message, self.bus_id, BUS_ID_LENGTH);
        for number in [
            u32::from(self.bus),
            u32::from(self.number),
            Self::FULL_SPEED,
        ] {
            message.extend(number.to_be_bytes());
        }
        for number in [self.vendor_id, self.product_id, self.release] {
            message.extend(number.to_be_bytes());
        }
        message.extend(self.class);
        message.extend([self.configuration, self.configurations]);
        message.push(u8::try_from(self.named_interfaces().len()).unwrap_or(u8::MAX));
    }
}

/// `OP_REP_DEVLIST` with the device, or with none.
pub fn list_reply(device: Option<&DeviceRecord>) -> Vec<u8> {
    let mut message = operation_reply(OP_REP_DEVLIST, 0);
    message.extend(u32::from(device.is_some()).to_be_bytes());
    if let Some(device) = device {
        device.append_to(&mut message);
        for [class, subclass, protocol] in device.named_interfaces() {
            message.extend([*class, *subclass, *protocol, 0]);
        }
    }
    message
}

/// `OP_REP_IMPORT` with the device, or why it is refused.
pub fn import_reply(answer: Result<&DeviceRecord, Refusal>) -> Vec<u8> {
    match answer {
        Ok(device) => {
            let mut message = operation_reply(OP_REP_IMPORT, 0);
            device.append_to(&mut message);
            message
        }
        Err(refusal) => operation_reply(OP_REP_IMPORT, refusal as u32),
    }
}

/// Result of a transfer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The number of the transfer.
    pub sequence: u32,
    /// 0, or the negative number of a Linux error.
    pub status: i32,
    /// Number of bytes transferred.
    pub moved: usize,
    /// The number of packets as the client gave it.
    pub packets: u32,
    /// The data of an IN transfer: `moved` bytes.
    pub data: Vec<u8>,
}

impl Completion {
    /// `RET_SUBMIT`.
    pub fn encode(&self) -> Vec<u8> {
        // At most MAX_TRANSFER.
        let moved = u32::try_from(self.moved).unwrap_or(u32::MAX);
        let status = self.status.cast_unsigned();
        // Start frame and number of errors belong to isochronous transfers.
        let body = [status, moved, 0, self.packets, 0];
        let mut message = reply_header(RET_SUBMIT, self.sequence, body);
        message.extend(&self.data);
        message
    }
}

/// `RET_UNLINK`: 0, or the negative number of a Linux error.
pub fn unlink_reply(sequence: u32, status: i32) -> Vec<u8> {
    reply_header(RET_UNLINK, sequence, [status.cast_unsigned(), 0, 0, 0, 0])
}

/// The header of a reply: device, direction and endpoint are 0, and the last eight bytes.
fn reply_header(command: u32, sequence: u32, body: [u32; 5]) -> Vec<u8> {
    let mut message = Vec::with_capacity(HEADER_LENGTH);
    for word in [command, sequence, 0, 0, 0].into_iter().chain(body) {
        message.extend(word.to_be_bytes());
    }
    message.resize(HEADER_LENGTH, 0);
    message
}

fn operation_reply(code: u16, status: u32) -> Vec<u8> {
    let mut message = Vec::new();
    message.extend(VERSION.to_be_bytes());
    message.extend(code.to_be_bytes());
    message.extend(status.to_be_bytes());
    message
}

/// Text in a field of this length, with at least one zero byte behind it.
fn append_text(message: &mut Vec<u8>, text: &str, length: usize) {
    let end = message.len() + length;
    message.extend(text.bytes().take(length - 1));
    message.resize(end, 0);
}

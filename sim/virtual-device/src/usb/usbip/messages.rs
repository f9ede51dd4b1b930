//! The bytes of USB/IP 1.1.1: big-endian numbers, but USB's own structures as they are.
//!
//! ```text
//!   client                                       server
//!   OP_REQ_DEVLIST  8 bytes            ──▶
//!                                      ◀──  OP_REP_DEVLIST  12, for each device 312 and its interfaces
//!   OP_REQ_IMPORT   8 + 32 (bus id)    ──▶
//!                                      ◀──  OP_REP_IMPORT   8, and 312 if the status is 0
//!   CMD_SUBMIT     48 + data (OUT)     ──▶
//!                                      ◀──  RET_SUBMIT     48 + data (IN)
//!   CMD_UNLINK     48                  ──▶
//!                                      ◀──  RET_UNLINK     48
//! ```
//! Source: the Linux kernel's `Documentation/usb/usbip_protocol.rst` and `drivers/usb/usbip`.

mod reply;
mod request;

pub use reply::{Completion, DeviceRecord, Refusal, import_reply, list_reply, unlink_reply};
pub use request::{Command, Direction, MessageError, Operation, Submit};

/// The version of the protocol, as it stands in a message.
pub const VERSION: u16 = 0x0111;

/// The longest transfer, bytes. Linux's serial driver uses at most 1,280 to a full-speed device.
pub const MAX_TRANSFER: usize = 256 * 1024;

/// The length of a bus id in a message, bytes: text that ends with a zero byte.
pub const BUS_ID_LENGTH: usize = 32;

/// The length of a header in front of commands and their replies, bytes.
pub const HEADER_LENGTH: usize = 48;

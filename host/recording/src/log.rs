//! The file of a recording in progress: the device's own blocks, appended as
//! they arrive, so that a kill, a full disk or a power cut costs the end only.
//!
//! ```text
//! file       = magic ‖ 0x00 ‖ frame …
//! frame      = COBS(body ‖ CRC-32(body), little endian) ‖ 0x00     as on the wires
//! body       = 'T' ‖ tag ‖ postcard block                          the device's own
//!            | 'J' ‖ '2' ‖ JSON entry                              ours
//!
//! header     what is recorded: title, device, program; the first frame
//! subscribed where the accounting begins, and where it goes on after a lost connection
//! parameters in force from the next block on: all, or those that have changed
//! checkpoint every second, and at the end: SHA-256 of the bytes since the last one,
//!            the number of blocks, the sums of the accounting
//! ```
//!
//! Every byte is covered twice: by the CRC-32 of its frame and, but for what
//! came after the last checkpoint, by a SHA-256. Frames carry no zero byte, so
//! reading goes on behind damage at the next one.

pub(crate) mod disk;
pub(crate) mod frame;
pub(crate) mod reader;
pub(crate) mod recorder;
mod repair;

/// The first bytes of the file.
pub(crate) const MAGIC: &[u8] = b"crepitus recording 2\0";

/// More bytes than any frame has.
const FRAME_LIMIT: u64 = 1 << 20;

/// Blocks between two checkpoints: a second.
pub(crate) const CHECKPOINT_BLOCKS: u64 = 1_000;

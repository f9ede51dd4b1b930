//! Frames of the file.

use crate::books::{Begin, Totals};
use crate::metadata::Metadata;
use crate::parameters::Named;
use crepitus_protocol::Lane;
use crepitus_protocol::frame::{CRC, CRC_BYTES, DELIMITER};
use crepitus_protocol::telemetry::Block;
use serde::{Deserialize, Serialize};
use std::io;

/// Lane and tag of our own frames.
const ENTRY: [u8; 2] = *b"J2";

/// What the device does not say in its blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "kebab-case")]
pub(crate) enum Entry {
    /// The first frame.
    Header(Box<Metadata>),
    /// A subscription begins.
    Subscribed(Begin),
    /// Parameters, from the next block on.
    Parameters {
        /// From 0.
        number: u64,
        revision: u32,
        /// Whether `values` holds all parameters, not only those that have
        /// changed.
        is_whole: bool,
        /// None if they are unknown.
        values: Option<Named>,
    },
    /// See the module.
    Checkpoint(Checkpoint),
}

/// What stands in the file up to here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// The recording's.
    pub(crate) id: String,
    /// From 0.
    pub(crate) number: u64,
    /// Of the bytes since the last checkpoint, hexadecimal.
    pub(crate) sha256: String,
    /// So far.
    pub(crate) totals: Totals,
    /// Whether the recording ends here.
    pub(crate) is_end: bool,
}

impl Entry {
    /// As a frame, with its delimiter.
    pub(crate) fn frame(&self) -> io::Result<Vec<u8>> {
        let mut body = ENTRY.to_vec();
        serde_json::to_writer(&mut body, self)?;
        let checksum = CRC.checksum(&body);
        body.extend(checksum.to_le_bytes());
        let mut frame = cobs::encode_vec(&body);
        frame.push(DELIMITER);
        Ok(frame)
    }
}

/// What a frame holds.
pub(crate) enum Content {
    Block(Box<Block>),
    Entry(Box<Entry>),
}

impl Content {
    /// Opens a frame without its delimiter, in place; none if it is damaged.
    pub(crate) fn of(frame: &mut [u8]) -> Option<Self> {
        let length = cobs::decode_in_place(frame).ok()?;
        let (body, checksum) = frame.get(..length)?.split_last_chunk::<CRC_BYTES>()?;
        if CRC.checksum(body) != u32::from_le_bytes(*checksum) {
            return None;
        }
        let (kind, payload) = body.split_first_chunk::<2>()?;
        if *kind == ENTRY {
            return serde_json::from_slice(payload)
                .ok()
                .map(|entry| Self::Entry(Box::new(entry)));
        }
        // The tag is that of the wire's schema; `FORMAT` is that of blocks here.
        if kind[0] != Lane::Telemetry.byte() {
            return None;
        }
        match postcard::take_from_bytes(payload) {
            Ok((block, [])) => Some(Self::Block(Box::new(block))),
            _ => None,
        }
    }
}

//! Frames of the file.

use crate::accounting::Totals;

use crate::ending::Ending;
use crate::metadata::Metadata;
use crate::parameters::Named;
use crate::row::END_TICK as MOST;
use crepitus_protocol::Lane;
use crepitus_protocol::accounting::Begin;
use crepitus_protocol::frame::{CRC, CRC_BYTES, DELIMITER, Frame, TooLong, encode};
use crepitus_protocol::telemetry::Block;
use serde::{Deserialize, Serialize};
use std::io;

/// Lane and tag of our own frames.
const ENTRY: [u8; 2] = *b"J2";

/// Entries between the device's blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "kebab-case")]
pub(crate) enum Entry {
    /// The first frame.
    Header(Box<Metadata>),
    /// A subscription begins.
    Subscribed(Begin),
    /// Parameters, from the next block on.
    Parameters {
        /// Number of the parameter entry, from 0.
        number: u64,
        revision: u32,
        /// `values` holds all parameters, not only those that have changed.
        is_whole: bool,
        /// None if they are unknown.
        values: Option<Named>,
    },
    /// See the module.
    Checkpoint(Checkpoint),
}

/// Sums of the file up to here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// The recording's.
    pub(crate) id: String,
    /// Number of the checkpoint, from 0.
    pub(crate) number: u64,
    /// SHA-256 of the bytes since the last checkpoint, hexadecimal.
    pub(crate) sha256: String,
    /// Totals so far.
    pub(crate) totals: Totals,
    /// The recording ends here.
    pub(crate) is_end: bool,
    /// End of the recording, if its program says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ending: Option<Ending>,
}

impl Entry {
    /// Returns the entry as a frame, with its delimiter.
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

/// A block as the device's own frame. Apart from the recorder, which is generic and so compiled
/// where it is used: there are thousands of blocks a second.
pub(crate) fn of_block(block: &Block) -> Result<Frame, TooLong> {
    encode(Lane::Telemetry, block)
}

impl Entry {
    fn is_plausible(&self) -> bool {
        match self {
            Self::Header(_) => true,
            Self::Subscribed(begin) => begin.first_tick < MOST,
            Self::Parameters { number, .. } => *number < MOST,
            Self::Checkpoint(checkpoint) => {
                let ending = checkpoint.ending.as_ref();
                let end = ending.and_then(|ending| ending.produced_to_tick);
                checkpoint.number < MOST && end.is_none_or(|tick| tick < MOST)
            }
        }
    }
}

/// Content of a frame.
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
            let entry: Entry = serde_json::from_slice(payload).ok()?;
            return entry.is_plausible().then(|| Self::Entry(Box::new(entry)));
        }
        // The tag is that of the wire's schema; `FORMAT` is that of blocks here.
        if kind[0] != Lane::Telemetry.byte() {
            return None;
        }
        match postcard::take_from_bytes::<Block>(payload) {
            Ok((block, [])) if block.first_tick < MOST => Some(Self::Block(Box::new(block))),
            _ => None,
        }
    }
}

/// The recording whose file is read. Behind the header of another one, nothing
/// is its own up to its next checkpoint.
#[derive(Debug, Default)]
pub(crate) struct Owner {
    id: Option<String>,
    is_elsewhere: bool,
}

impl Owner {
    /// True if the next content is this recording's, as far as that can be determined.
    pub(crate) fn owns(&mut self, content: &Content) -> bool {
        if let Content::Entry(entry) = content {
            match &**entry {
                Entry::Header(metadata) => {
                    let id = self.id.get_or_insert_with(|| metadata.id.clone());
                    self.is_elsewhere = *id != metadata.id;
                }
                Entry::Checkpoint(checkpoint) if self.id.as_ref() == Some(&checkpoint.id) => {
                    self.is_elsewhere = false;
                }
                _ => {}
            }
        }
        !self.is_elsewhere
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_read(frame: &[u8]) -> bool {
        let (_, body) = frame.split_last().expect("a delimiter");
        Content::of(&mut body.to_vec()).is_some()
    }

    #[test]
    fn counts_that_nobody_has_reached_are_refused_before_they_overflow() {
        for (first_tick, is_ours) in [(MOST - 1, true), (MOST, false), (u64::MAX, false)] {
            let block = Block {
                first_tick,
                ..Block::default()
            };
            let frame = encode(Lane::Telemetry, &block).expect("a block fits");
            assert_eq!(is_read(&frame), is_ours, "{first_tick}");
            let begin = Entry::Subscribed(Begin {
                first_tick,
                ..Begin::default()
            });
            let parameters = Entry::Parameters {
                number: first_tick,
                revision: 1,
                is_whole: true,
                values: None,
            };
            for entry in [begin, parameters] {
                assert_eq!(is_read(&entry.frame().expect("JSON")), is_ours, "{entry:?}");
            }
        }
    }
}

//! Frames and messages from comms to hosts.

use crepitus_protocol::frame::DELIMITER;
use crepitus_protocol::host::Reply;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane, management};
use std::io::BufRead;

/// Frames of comms, from its bytes.
#[derive(Default)]
pub(crate) struct Frames {
    /// A frame of which not all bytes have come.
    partial: Vec<u8>,
}

impl Frames {
    /// The connection was lost, with the bytes in flight.
    pub(crate) fn cut(&mut self) {
        self.partial.clear();
    }

    /// Passes on each frame that `bytes` complete. They are searched for
    /// delimiters at once, not byte by byte: most of this is telemetry.
    pub(crate) fn split(&mut self, mut bytes: &[u8], mut pass: impl FnMut(&[u8])) {
        while let Ok(1..) = bytes.read_until(DELIMITER, &mut self.partial) {
            if self.partial.last() == Some(&DELIMITER) {
                // An empty one comes before the first.
                if self.partial.len() > 1 {
                    pass(&self.partial);
                }
                self.partial.clear();
            }
        }
    }
}

/// Returns whether a frame is a block: its lane, after the first code of COBS.
pub(crate) fn is_block(frame: &[u8]) -> bool {
    frame.get(1) == Some(&Lane::Telemetry.byte())
}

/// A message for hosts.
#[expect(clippy::large_enum_variant, reason = "one at a time")]
pub(crate) enum FromComms {
    Reply(Reply),
    Block(Block),
    Answer,
}

impl FromComms {
    /// Decodes a frame.
    ///
    /// # Panics
    /// If it is not in order.
    pub(crate) fn of(frame: &[u8]) -> Self {
        let mut decoder = Decoder::new();
        let mut found = frame.iter().filter_map(|byte| {
            let body = decoder.push(*byte)?.expect("a frame in order");
            Some(match body.lane() {
                Some(Lane::Reply) => Self::Reply(body.message().expect("a reply")),
                Some(Lane::Telemetry) => Self::Block(body.message().expect("a block")),
                Some(Lane::ManagementAnswer) => {
                    assert!(management::Answer::of(body.payload).is_some());
                    Self::Answer
                }
                other => panic!("{other:?} from comms"),
            })
        });
        found.next().expect("a frame")
    }
}

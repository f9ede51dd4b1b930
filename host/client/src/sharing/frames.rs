//! Whole frames out of a stream of bytes, unchanged.

use crepitus_protocol::frame::{DELIMITER, FRAME_BYTES};

/// Collects bytes into frames. What is longer than any frame is discarded up to
/// the next delimiter.
#[derive(Debug, Default)]
pub(crate) struct Frames {
    partial: Vec<u8>,
    is_overlong: bool,
}

impl Frames {
    /// Takes bytes; calls `each` with every frame that they complete, with its
    /// delimiter.
    pub(crate) fn push(&mut self, bytes: &[u8], mut each: impl FnMut(&[u8])) {
        for run in bytes.split_inclusive(|byte| *byte == DELIMITER) {
            if self.partial.len() + run.len() > FRAME_BYTES {
                self.is_overlong = true;
                self.partial.clear();
            }
            if !self.is_overlong {
                self.partial.extend_from_slice(run);
            }
            if run.last() == Some(&DELIMITER) {
                // A delimiter alone is no frame.
                if self.partial.len() > 1 && !self.is_overlong {
                    each(&self.partial);
                }
                self.partial.clear();
                self.is_overlong = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_whole_however_the_bytes_arrive() {
        let long = [&[7; FRAME_BYTES][..], &[0]].concat();
        let longest = [&[8; FRAME_BYTES - 1][..], &[0]].concat();
        let stream = [&[0, 1, 2, 0, 0, 3, 0][..], &long, &longest, &[4, 0, 5]].concat();
        for size in [1, 2, 3, 64, 1_000] {
            let mut frames = Frames::default();
            let mut found = Vec::new();
            for bytes in stream.chunks(size) {
                frames.push(bytes, |frame| found.push(frame.to_vec()));
            }
            assert_eq!(
                found,
                [vec![1, 2, 0], vec![3, 0], longest.clone(), vec![4, 0]],
                "pieces of {size} bytes"
            );
        }
    }
}

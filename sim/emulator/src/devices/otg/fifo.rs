//! The FIFOs: one for all that is received, one to transmit for each endpoint.

use super::ENDPOINTS;
use std::collections::VecDeque;

/// PKTSTS of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A packet from the host.
    Out = 2,
    /// The transfer is complete.
    OutDone = 3,
    /// The SETUP stage is.
    SetupDone = 4,
    /// A SETUP packet.
    Setup = 6,
}

/// A status word and its data.
#[derive(Debug)]
struct Entry {
    status: u32,
    words: VecDeque<u32>,
}

/// FIFO of received entries, in order.
#[derive(Debug, Default)]
pub(super) struct ReceiveFifo {
    /// GRXFSIZ, words.
    pub(super) depth: u32,
    entries: VecDeque<Entry>,
    /// Data of the entry whose status was taken last.
    current: VecDeque<u32>,
}

impl ReceiveFifo {
    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// GRXSTSR.
    pub(super) fn status(&self) -> u32 {
        self.entries.front().map_or(0, |entry| entry.status)
    }

    /// GRXSTSP.
    pub(super) fn pop(&mut self) -> u32 {
        self.entries.pop_front().map_or(0, |entry| {
            self.current = entry.words;
            entry.status
        })
    }

    /// A word of the packet whose status was taken last.
    pub(super) fn take_word(&mut self) -> u32 {
        self.current.pop_front().unwrap_or(0)
    }

    pub(super) fn flush(&mut self) {
        self.entries.clear();
        self.current.clear();
    }

    /// Returns whether there is room for a packet of this many bytes, with its status and
    /// that of its completion.
    pub(super) fn has_room_for(&self, bytes: usize) -> bool {
        let words = |entry: &Entry| 1 + entry.words.len();
        let used = self.current.len() + self.entries.iter().map(words).sum::<usize>();
        used + bytes.div_ceil(4) + 2 <= self.depth as usize
    }

    pub(super) fn push(&mut self, endpoint: usize, kind: Kind, data: &[u8]) {
        let words = data.chunks(4).map(|chunk| {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            u32::from_le_bytes(word)
        });
        let status = endpoint | data.len() << 4 | (kind as usize) << 17;
        self.entries.push_back(Entry {
            status: u32::try_from(status).unwrap_or_default(),
            words: words.collect(),
        });
    }
}

/// FIFOs of data to be transmitted.
#[derive(Debug, Default)]
pub(super) struct TransmitFifos {
    /// DIEPTXF0 to DIEPTXF3: start, and depth in words above.
    setups: [u32; ENDPOINTS],
    words: [VecDeque<u32>; ENDPOINTS],
    is_too_full: bool,
}

impl TransmitFifos {
    pub(super) fn setup(&self, n: usize) -> u32 {
        self.setups.get(n).copied().unwrap_or(0)
    }

    pub(super) fn set_up(&mut self, n: usize, value: u32) {
        if let Some(setup) = self.setups.get_mut(n) {
            *setup = value;
        }
    }

    pub(super) fn is_empty(&self, n: usize) -> bool {
        self.words.get(n).is_none_or(VecDeque::is_empty)
    }

    /// Free words.
    pub(super) fn room(&self, n: usize) -> u32 {
        let used = self.words.get(n).map_or(0, VecDeque::len);
        (self.setup(n) >> 16).saturating_sub(u32::try_from(used).unwrap_or(u32::MAX))
    }

    pub(super) fn push(&mut self, n: usize, word: u32) {
        if self.room(n) == 0 {
            self.is_too_full = true;
        } else if let Some(words) = self.words.get_mut(n) {
            words.push_back(word);
        }
    }

    /// Returns whether a program has written more than there was room for.
    pub(super) fn is_too_full(&self) -> bool {
        self.is_too_full
    }

    /// Takes a packet, if it is there whole.
    pub(super) fn take(&mut self, n: usize, bytes: usize) -> Option<Vec<u8>> {
        let words = self.words.get_mut(n)?;
        let count = bytes.div_ceil(4);
        if words.len() < count {
            return None;
        }
        let mut packet: Vec<u8> = words.drain(..count).flat_map(u32::to_le_bytes).collect();
        packet.truncate(bytes);
        Some(packet)
    }

    /// Empties one, or all (16).
    pub(super) fn flush(&mut self, which: u32) {
        for (n, words) in (0..).zip(&mut self.words) {
            if which == n || which == 16 {
                words.clear();
            }
        }
    }
}

//! The words of the post-mortem record: its layout in RAM, and its checksum.

use core::sync::atomic::{AtomicU32, Ordering};
use crepitus_protocol::crash::{HEAD_WORDS, Head, TICK_WORDS, TICKS};
use crepitus_protocol::frame::CRC;

/// A word of RAM that a reset leaves alone.
type Word = AtomicU32;

/// The ring of the last ticks.
pub(crate) type Ring = [[Word; TICK_WORDS]; TICKS];

/// No head has these words.
const NO_HEAD: [u32; HEAD_WORDS] = [u32::MAX; HEAD_WORDS];

/// A record, and its checksum.
pub(crate) struct CheckedRecord {
    head: [Word; HEAD_WORDS],
    ticks: Ring,
    checksum: Word,
}

impl CheckedRecord {
    /// Initial value in the source; the section is not initialised at start.
    pub(crate) const fn empty() -> Self {
        Self {
            head: [const { Word::new(0) }; HEAD_WORDS],
            ticks: empty_ring(),
            checksum: Word::new(0),
        }
    }

    /// Stores a head with the last ticks, and their checksum.
    pub(crate) fn fill(&self, head: &Head, ticks: &Ring) {
        store(&self.head, head.words());
        let ticks = ticks.as_flattened().iter();
        let ticks = ticks.map(|word| word.load(Ordering::Relaxed));
        store(self.ticks.as_flattened(), ticks);
        self.checksum
            .store(self.computed_checksum(), Ordering::Relaxed);
    }

    /// Removes the head, without which there is no record.
    pub(crate) fn clear(&self) {
        store(&self.head, NO_HEAD);
    }

    /// The head, if there is a record.
    pub(crate) fn head(&self) -> Option<Head> {
        let mut words = NO_HEAD;
        for (to, word) in words.iter_mut().zip(&self.head) {
            *to = word.load(Ordering::Relaxed);
        }
        Head::of(&words)
    }

    /// A word of the head, or after it of the ticks.
    pub(crate) fn word(&self, place: usize) -> Option<u32> {
        let ticks = self.ticks.as_flattened();
        let word = self.head.get(place);
        let word = word.or_else(|| ticks.get(place.checked_sub(HEAD_WORDS)?));
        word.map(|word| word.load(Ordering::Relaxed))
    }

    /// Returns whether the words have their checksum.
    pub(crate) fn is_whole(&self) -> bool {
        self.checksum.load(Ordering::Relaxed) == self.computed_checksum()
    }

    fn words(&self) -> impl Iterator<Item = u32> {
        let ticks = self.ticks.as_flattened();
        let words = self.head.iter().chain(ticks);
        words.map(|word| word.load(Ordering::Relaxed))
    }

    fn computed_checksum(&self) -> u32 {
        let mut digest = CRC.digest();
        for word in self.words() {
            digest.update(&word.to_le_bytes());
        }
        digest.finalize()
    }
}

/// Returns the ring's initial value, as in [`CheckedRecord::empty`].
pub(crate) const fn empty_ring() -> Ring {
    [const { [const { Word::new(0) }; TICK_WORDS] }; TICKS]
}

/// Stores words, as many as there is room for.
pub(crate) fn store(to: &[Word], words: impl IntoIterator<Item = u32>) {
    for (to, word) in to.iter().zip(words) {
        to.store(word, Ordering::Relaxed);
    }
}

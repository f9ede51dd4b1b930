//! The post-mortem record in RAM that a reset leaves alone, see
//! [`crepitus_protocol::crash`].
//!
//! The drive stores every tick in a ring there, five words. A program that can
//! still do so completes the record as it ends; after a watchdog reset, where
//! nothing could, the next start does.

use crate::raw;
use crate::reset_record::{Reason, ResetRecord};
use core::sync::atomic::{AtomicU32, Ordering};
use crepitus_protocol::crash::{
    End, HEAD_WORDS, Head, NO_TICK_WORDS, Part, TICK_WORDS, TICKS, Tick,
};
use crepitus_protocol::frame::CRC;
use crepitus_protocol::management::ResetCause;

/// A word of RAM that a reset leaves alone.
type Word = AtomicU32;

/// The ring of the last ticks.
pub(crate) type Ring = [[Word; TICK_WORDS]; TICKS];

/// A record, and its checksum.
pub(crate) struct Kept {
    head: [Word; HEAD_WORDS],
    ticks: Ring,
    checksum: Word,
}

impl Kept {
    /// Initial value in the source; the section is not initialised at start.
    pub(crate) const fn empty() -> Self {
        Self {
            head: [const { Word::new(0) }; HEAD_WORDS],
            ticks: empty_ring(),
            checksum: Word::new(0),
        }
    }

    fn words(&self) -> impl Iterator<Item = u32> {
        let ticks = self.ticks.as_flattened();
        let words = self.head.iter().chain(ticks);
        words.map(|word| word.load(Ordering::Relaxed))
    }

    fn word(&self, place: usize) -> Option<u32> {
        let ticks = self.ticks.as_flattened();
        let word = self.head.get(place);
        let word = word.or_else(|| ticks.get(place.checked_sub(HEAD_WORDS)?));
        word.map(|word| word.load(Ordering::Relaxed))
    }

    fn computed_checksum(&self) -> u32 {
        let mut digest = CRC.digest();
        for word in self.words() {
            digest.update(&word.to_le_bytes());
        }
        digest.finalize()
    }

    fn is_whole(&self) -> bool {
        self.checksum.load(Ordering::Relaxed) == self.computed_checksum()
    }
}

/// Returns the ring's initial value, as in [`Kept::empty`].
pub(crate) const fn empty_ring() -> Ring {
    [const { [const { Word::new(0) }; TICK_WORDS] }; TICKS]
}

/// Stores the last ticks.
pub struct BlackBox(());

impl BlackBox {
    /// Returns a black box with no ticks yet.
    pub(crate) fn new() -> Self {
        for slot in &raw::LAST_TICKS {
            store(slot, NO_TICK_WORDS);
        }
        Self(())
    }

    /// Stores a tick.
    pub fn record(&mut self, tick: &Tick) {
        if let Some(slot) = raw::LAST_TICKS.get(tick.slot()) {
            store(slot, tick.words());
        }
    }
}

/// Completes the record as a program ends.
pub(crate) fn keep(head: &Head) {
    let kept = &raw::CRASH;
    store(&kept.head, head.words());
    let ticks = raw::LAST_TICKS.as_flattened().iter();
    let ticks = ticks.map(|word| word.load(Ordering::Relaxed));
    store(kept.ticks.as_flattened(), ticks);
    kept.checksum
        .store(kept.computed_checksum(), Ordering::Relaxed);
}

/// Completes it as the next program starts, if the last could not. `record` is what
/// that has left. A record that is not whole, as after power-on, is emptied.
pub(crate) fn complete(cause: ResetCause, record: Option<&ResetRecord>) {
    // One that could store its reason has stored its record, too.
    if cause == ResetCause::Watchdog
        && let Some(record) = record.filter(|record| record.reason == Reason::None)
    {
        keep(&Head::new(record.start, End::Watchdog, 0));
    }
    if !raw::CRASH.is_whole() {
        store(&raw::CRASH.head, NO_HEAD);
    }
}

/// No head has these words.
const NO_HEAD: [u32; HEAD_WORDS] = [u32::MAX; HEAD_WORDS];

/// Post-mortem record of the last crash, without its ticks.
pub fn head() -> Option<Head> {
    let mut words = NO_HEAD;
    for (to, word) in words.iter_mut().zip(&raw::CRASH.head) {
        *to = word.load(Ordering::Relaxed);
    }
    Head::of(&words)
}

/// A part of the record.
pub fn part(number: u8) -> Part {
    let is_there = head().is_some();
    Part::of(number, |place| raw::CRASH.word(place).filter(|_| is_there))
}

fn store(to: &[Word], words: impl IntoIterator<Item = u32>) {
    for (to, word) in to.iter().zip(words) {
        to.store(word, Ordering::Relaxed);
    }
}

//! The post-mortem record in RAM that a reset leaves alone, see
//! [`crepitus_protocol::crash`].
//!
//! The drive stores every tick in a ring there, five words. A program that can
//! still do so completes the record as it ends; after a watchdog reset, where
//! nothing could, the next start does.

use crate::crash_record::store;
use crate::raw;
use crate::reset_record::{Reason, ResetRecord};
use crepitus_protocol::crash::{End, Head, NO_TICK_WORDS, Part, Tick};
use crepitus_protocol::management::ResetCause;

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
    raw::CRASH.fill(head, &raw::LAST_TICKS);
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
        raw::CRASH.clear();
    }
}

/// Post-mortem record of the last crash, without its ticks.
pub fn head() -> Option<Head> {
    raw::CRASH.head()
}

/// A part of the record.
pub fn part(number: u8) -> Part {
    let is_there = head().is_some();
    Part::of(number, |place| raw::CRASH.word(place).filter(|_| is_there))
}

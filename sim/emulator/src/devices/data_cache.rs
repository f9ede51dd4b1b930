//! Content of the data cache of flash (RM0090 3.5.2, 3.6.3): which bytes it may hold, and which of
//! them an erasure has left behind.
//!
//! | event | bytes that it may hold | bytes that are stale |
//! |---|---|---|
//! | a load while `DCEN` is set | the 16 of its line are | |
//! | an erasure | | those of the sector that it may hold are |
//! | programming | | those that are written no longer are: the cache is written, too |
//! | `DCRST` while `DCEN` is clear; a reset of the chip | none | none |
//!
//! A line counts as held until the cache is reset, though it has room for eight: which line is
//! replaced depends on every literal that is loaded, so no program may rely on it.

use crate::chip::part::lock;
use crate::flash_interface::LINE_BYTES;
use crate::image::{FLASH, FLASH_BYTES};
use crate::refusal::{Refusal, Refusals};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

const LINE: usize = LINE_BYTES as usize;
const WORDS: usize = FLASH_BYTES / LINE / 64;

/// The cache.
pub(crate) struct DataCache {
    is_enabled: AtomicBool,
    /// Lines that it may hold, one bit each.
    held: Vec<AtomicU64>,
    /// Whether any byte is stale.
    has_stale: AtomicBool,
    /// Offsets of the stale bytes.
    stale: Mutex<BTreeSet<usize>>,
    refusals: Arc<Refusals>,
}

impl DataCache {
    pub(crate) fn new(refusals: Arc<Refusals>) -> Self {
        Self {
            is_enabled: AtomicBool::new(false),
            held: (0..WORDS).map(|_| AtomicU64::new(0)).collect(),
            has_stale: AtomicBool::new(false),
            stale: Mutex::default(),
            refusals,
        }
    }

    /// Takes `DCEN` and `DCRST`.
    pub(crate) fn set(&self, is_enabled: bool, is_reset: bool) {
        self.is_enabled.store(is_enabled, Relaxed);
        if is_reset && is_enabled {
            self.refusals.refuse(Refusal::CacheResetWhileEnabled);
        } else if is_reset {
            self.clear();
        }
    }

    /// Empties it.
    pub(crate) fn clear(&self) {
        for word in &self.held {
            word.store(0, Relaxed);
        }
        lock(&self.stale).clear();
        self.has_stale.store(false, Relaxed);
    }

    /// Takes a load of the core.
    #[inline]
    pub(crate) fn load(&self, offset: usize, bytes: usize) {
        if !self.is_enabled.load(Relaxed) {
            return;
        }
        if self.has_stale.load(Relaxed) {
            self.check(offset, bytes);
        }
        for line in [offset / LINE, (offset + bytes.saturating_sub(1)) / LINE] {
            let Some(word) = self.held.get(line / 64) else {
                return;
            };
            let bit = 1 << (line % 64);
            if word.load(Relaxed) & bit == 0 {
                word.fetch_or(bit, Relaxed);
            }
        }
    }

    fn check(&self, offset: usize, bytes: usize) {
        let stale = lock(&self.stale);
        if let Some(first) = stale.range(offset..offset + bytes).next() {
            let address = FLASH + u32::try_from(*first).unwrap_or_default();
            self.refusals.refuse(Refusal::StaleData { address });
        }
    }

    /// Takes an erasure of these bytes.
    pub(crate) fn erased(&self, range: &Range<usize>) {
        let is_held = |line: &usize| {
            let word = self.held.get(line / 64);
            word.is_some_and(|word| word.load(Relaxed) >> (line % 64) & 1 == 1)
        };
        let lines = (range.start / LINE..range.end.div_ceil(LINE)).filter(is_held);
        let mut stale = lock(&self.stale);
        stale.extend(lines.flat_map(|line| line * LINE..(line + 1) * LINE));
        self.has_stale.store(!stale.is_empty(), Relaxed);
    }

    /// Takes bytes that are programmed.
    pub(crate) fn programmed(&self, range: Range<usize>) {
        if self.has_stale.load(Relaxed) {
            let mut stale = lock(&self.stale);
            for byte in range {
                stale.remove(&byte);
            }
        }
    }
}

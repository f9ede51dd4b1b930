//! Waits of the core in a step: for flash and for registers.
//!
//! Off, unless [`crate::Stm32f405::model_flash`] is called.

use super::part::lock;
use crate::flash_interface::{FlashInterface, FlashRead, Kind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Sum of waits, and what decides them.
#[derive(Debug, Default)]
pub(crate) struct Waits {
    is_on: AtomicBool,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    flash: FlashInterface,
    /// Time of the next access of this step, in cycles of the core's clock.
    at: u64,
    /// Cycles that the core has waited in this step.
    waits: u64,
    /// An instruction has been fetched in this step.
    has_fetched: bool,
    /// Reads since the last call of [`Waits::take_reads`], if they are recorded.
    reads: Option<Vec<FlashRead>>,
}

impl Waits {
    pub(crate) fn is_on(&self) -> bool {
        self.is_on.load(Relaxed)
    }

    pub(crate) fn switch_on(&self) {
        self.is_on.store(true, Relaxed);
    }

    /// A step of the core begins.
    pub(crate) fn begin(&self, at: u64) {
        lock(&self.state).begin(at);
    }

    /// The step's waits.
    pub(crate) fn end(&self) -> u64 {
        lock(&self.state).waits
    }

    /// Reads flash.
    pub(crate) fn flash(&self, offset: u32, is_fetch: bool) {
        lock(&self.state).flash(offset, is_fetch);
    }

    /// A whole step that begins at `at`: an instruction of these half words, and its
    /// data. Returns its waits.
    pub(crate) fn step(
        &self,
        at: u64,
        fetched: impl Iterator<Item = u32>,
        data: impl Iterator<Item = u32>,
    ) -> u64 {
        let mut state = lock(&self.state);
        state.begin(at);
        for offset in fetched {
            state.flash(offset, true);
        }
        for offset in data {
            state.flash(offset, false);
        }
        state.waits
    }

    /// Accesses a register that makes the core wait.
    pub(crate) fn register(&self, waits: u64) {
        let mut state = lock(&self.state);
        state.waits += waits;
        state.at += waits + 1;
    }

    /// `FLASH_ACR` has been written.
    pub(crate) fn set_register(&self, value: u32) {
        lock(&self.state).flash.set_register(value);
    }

    /// Empties buffers and caches of flash.
    pub(crate) fn clear(&self) {
        lock(&self.state).flash.clear();
    }

    /// Records reads of flash from now on.
    pub(crate) fn record(&self) {
        lock(&self.state).reads = Some(Vec::new());
    }

    /// Takes the reads since the last call.
    pub(crate) fn take_reads(&self) -> Vec<FlashRead> {
        lock(&self.state)
            .reads
            .as_mut()
            .map(std::mem::take)
            .unwrap_or_default()
    }
}

impl State {
    fn begin(&mut self, at: u64) {
        self.at = at;
        self.waits = 0;
        self.has_fetched = false;
    }

    fn flash(&mut self, offset: u32, is_fetch: bool) {
        // A step that fetches nothing enters an exception, or leaves reset.
        let kind = match (is_fetch, self.has_fetched) {
            (true, _) => Kind::Instruction,
            (false, true) => Kind::Data,
            (false, false) => Kind::Vector,
        };
        self.has_fetched |= is_fetch;
        let at = self.at;
        let waits = self.flash.read(kind, offset, at);
        self.waits += waits;
        self.at += waits + u64::from(kind == Kind::Data);
        if let Some(reads) = &mut self.reads {
            reads.push(FlashRead {
                at,
                offset,
                kind,
                waits,
            });
        }
    }
}

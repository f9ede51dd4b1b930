//! Flash memory and its controller (RM0090 chapter 3), with the time that
//! writing takes, and with what is left when power fails.
//!
//! | operation | typical duration, 8 bits at a time |
//! |---|---|
//! | a byte | 16 µs |
//! | a sector of 16, 64, 128 KB erased | 0.4, 1.2, 2 s |
//!
//! From the data sheet of the STM32F405, table 40. While one lasts flash cannot be
//! read, so the core stops at its next instruction in it
//! ([`Flash::busy_until`]); timers, DMA and watchdog run on.
//!
//! Loads of the core go through the data cache, whose content is in
//! [`data_cache`](super::data_cache).
//!
//! A reset ends an operation in the middle, and leaves what
//! [`crepitus_virtual_device::nor_flash`] says.
//!
//! Not modelled: read-out and write protection, option bytes that are changed,
//! mass erase, the interrupt; [`Flash::uses_unmodelled_features`] reports their use.

use super::data_cache::DataCache;
use super::registers::Words;
use crate::chip::bus::Now;
use crate::chip::part::{Peripheral, lock};
use crate::image::FLASH_BYTES;
use crate::refusal::Refusals;
use crate::time::Time;
use crepitus_virtual_device::nor_flash::{Cut, Marginal};
use rsemu::core::error::BusError;
use rsemu::core::space::AccessPurpose;
use rsemu::core::space::{
    AccessConstraints, Mapping, MemAttrs, MemOps, MemResult, Perms, RamStore, Region, RegionRef,
};
use rsemu::cpu::arm::v7m::Config;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// A byte, or whatever is written at once.
const PROGRAM: Time = Time::from_us(16);

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

// CR.
const PG: u32 = 1;
const SER: u32 = 1 << 1;
const MER: u32 = 1 << 2;
const STRT: u32 = 1 << 16;
const EOPIE: u32 = 1 << 24;
const ERRIE: u32 = 1 << 25;
const LOCK: u32 = 1 << 31;

// SR.
const EOP: u32 = 1;
const PGPERR: u32 = 1 << 6;
const PGSERR: u32 = 1 << 7;
const BSY: u32 = 1 << 16;

/// Bits of ACR that are kept.
const ACR: u32 = 0x1f07;
const DCEN: u32 = 1 << 10;
const DCRST: u32 = 1 << 12;

/// Operation under way.
#[derive(Clone, Debug)]
enum Operation {
    Program { at: usize, bytes: Vec<u8> },
    Erase { range: Range<usize> },
}

#[derive(Debug)]
struct Running {
    operation: Operation,
    begin: u64,
    end: u64,
}

#[derive(Debug, Default)]
struct State {
    acr: u32,
    cr: u32,
    sr: u32,
    /// Keys that have been written, in order.
    keys: usize,
    /// A wrong one: locked until the next reset.
    is_barred: bool,
    running: Option<Running>,
    /// Sectors whose erasure was cut off.
    marginal: Vec<(Range<usize>, Marginal)>,
}

/// The memory and its controller.
pub(crate) struct Flash {
    array: Arc<RamStore>,
    /// Number of changes of the content.
    version: AtomicU64,
    state: Mutex<State>,
    data_cache: DataCache,
    option_bytes: u32,
    now: Now,
    /// End of the operation that is under way; 0 if none is.
    busy_until: AtomicU64,
    asked_too_much: AtomicBool,
}

/// The sector of a number, and how long erasing it takes.
fn sector(number: u32) -> Option<(Range<usize>, Time)> {
    const KB: usize = 1024;
    let number = number as usize;
    let (begin, length, ms) = match number {
        0..=3 => (number * 16 * KB, 16 * KB, 400),
        4 => (64 * KB, 64 * KB, 1_200),
        5..=11 => ((number - 4) * 128 * KB, 128 * KB, 2_000),
        _ => return None,
    };
    Some((begin..begin + length, Time::from_us(1_000 * ms)))
}

impl Flash {
    pub(crate) fn new(
        image: &[u8],
        option_bytes: u32,
        now: Now,
        refusals: Arc<Refusals>,
    ) -> Arc<Self> {
        let array = RamStore::new(FLASH_BYTES as u64);
        let flash = Self {
            array: Arc::new(array),
            version: AtomicU64::new(0),
            state: Mutex::default(),
            data_cache: DataCache::new(refusals),
            option_bytes,
            now,
            busy_until: AtomicU64::new(0),
            asked_too_much: AtomicBool::new(false),
        };
        flash.put(0, &vec![0xff; FLASH_BYTES]);
        flash.put(0, image);
        Peripheral::reset(&flash);
        Arc::new(flash)
    }

    /// The memory, as the core sees it: it is read like any, and written by
    /// the controller.
    pub(crate) fn region(self: &Arc<Self>) -> RegionRef {
        let bytes = FLASH_BYTES as u64;
        let read = Region::io("flash", bytes, Arc::new(Loads(self.clone())));
        let write = Region::io("flash controller", bytes, Arc::new(Writes(self.clone())));
        let parts = vec![
            Mapping::new(read, 0).with_perms(Perms::RX),
            Mapping::new(write, 0).with_perms(Perms::WRITE),
        ];
        Arc::new(Region::container("flash", bytes, parts))
    }

    /// Changes the content, as a programmer does.
    ///
    /// # Panics
    /// If that is longer than flash.
    pub(crate) fn put(&self, at: usize, bytes: &[u8]) {
        let stored = self.array.write_at(at as u64, bytes);
        stored.expect("within the memory");
        self.version.fetch_add(1, Relaxed);
    }

    /// The memory, for reading while [`Self::busy_until`] permits it.
    pub(crate) fn array(&self) -> Arc<RamStore> {
        self.array.clone()
    }

    /// Takes a load of the core, which the data cache may answer.
    #[inline]
    pub(crate) fn load(&self, offset: u64, bytes: usize) {
        if let Ok(offset) = usize::try_from(offset) {
            self.data_cache.load(offset, bytes);
        }
    }

    /// A number that is another after each change of the content.
    pub(crate) fn version(&self) -> u64 {
        self.version.load(Relaxed)
    }

    /// The content.
    pub(crate) fn content(&self, range: Range<usize>) -> Vec<u8> {
        let mut bytes = vec![0; range.len()];
        let read = self.array.read_at(range.start as u64, &mut bytes);
        read.expect("within the memory");
        bytes
    }

    /// Time until which flash cannot be read; 0 if it can.
    pub(crate) fn busy_until(&self) -> u64 {
        self.busy_until.load(Relaxed)
    }

    /// Returns whether a program has used a feature that is not modelled.
    pub(crate) fn uses_unmodelled_features(&self) -> bool {
        self.asked_too_much.load(Relaxed)
    }

    fn begin(&self, state: &mut State, operation: Operation, duration: Time) {
        let begin = self.now.load(Relaxed);
        let end = begin + duration.units();
        state.sr |= BSY;
        state.running = Some(Running {
            operation,
            begin,
            end,
        });
        self.busy_until.store(end, Relaxed);
    }

    /// Writes what an operation that is done leaves.
    fn finish(&self, state: &mut State, operation: Operation) {
        match operation {
            Operation::Program { at, bytes } => {
                let old = self.content(at..at + bytes.len());
                // Programming clears bits, and sets none.
                let new = old.iter().zip(&bytes).map(|(old, new)| old & new);
                self.put(at, &new.collect::<Vec<_>>());
                self.data_cache.programmed(at..at + bytes.len());
            }
            Operation::Erase { range } => {
                self.put(range.start, &vec![0xff; range.len()]);
                self.data_cache.erased(&range);
                state.marginal.retain(|(marginal, _)| *marginal != range);
            }
        }
        state.sr &= !BSY;
        state.sr |= if state.cr & EOPIE == 0 { 0 } else { EOP };
    }

    /// An operation was cut off.
    fn cut(&self, state: &mut State, running: Running) {
        let done = self.now.load(Relaxed).saturating_sub(running.begin);
        let cut = Cut::at(done, running.end - running.begin);
        match running.operation {
            Operation::Program { at, bytes } => {
                let mut old = self.content(at..at + bytes.len());
                cut.program(at, &mut old, &bytes);
                self.put(at, &old);
            }
            Operation::Erase { range } => {
                let mut bytes = self.content(range.clone());
                cut.erase(range.start, &mut bytes);
                self.put(range.start, &bytes);
                state.marginal.retain(|(marginal, _)| *marginal != range);
                state.marginal.push((range, Marginal::after(Some(cut))));
            }
        }
    }

    /// A store of the core.
    fn write(&self, at: usize, bytes: &[u8]) {
        let mut state = lock(&self.state);
        if state.running.is_some() {
            // From RAM; the bus would wait.
            self.asked_too_much.store(true, Relaxed);
        } else if state.cr & (LOCK | PG) != PG {
            state.sr |= PGSERR;
        } else if bytes.len() != 1 << (state.cr >> 8 & 3) {
            state.sr |= PGPERR;
        } else {
            let bytes = bytes.to_vec();
            self.begin(&mut state, Operation::Program { at, bytes }, PROGRAM);
        }
    }

    fn write_key(state: &mut State, value: u32) {
        if state.cr & LOCK == 0 || state.is_barred {
            return;
        }
        if KEYS.get(state.keys) == Some(&value) {
            state.keys += 1;
        } else {
            state.is_barred = true;
        }
        if state.keys == KEYS.len() {
            state.keys = 0;
            state.cr &= !LOCK;
        }
    }

    fn write_control(&self, state: &mut State, value: u32) {
        if state.cr & LOCK != 0 {
            return;
        }
        state.cr = value & !STRT;
        if value & (MER | EOPIE | ERRIE) != 0 {
            self.asked_too_much.store(true, Relaxed);
        }
        if value & STRT == 0 {
            return;
        }
        match sector(value >> 3 & 15).filter(|_| value & (SER | PG) == SER) {
            Some((range, duration)) if state.running.is_none() => {
                self.begin(state, Operation::Erase { range }, duration);
            }
            _ => state.sr |= PGSERR,
        }
    }
}

impl Peripheral for Flash {
    fn advance_to(&self, tick: u64) {
        let mut state = lock(&self.state);
        if let Some(running) = state.running.take_if(|running| running.end <= tick) {
            self.busy_until.store(0, Relaxed);
            self.finish(&mut state, running.operation);
        }
    }

    fn next_event(&self) -> Option<u64> {
        lock(&self.state)
            .running
            .as_ref()
            .map(|running| running.end)
    }

    fn reset(&self) {
        let mut state = lock(&self.state);
        if let Some(running) = state.running.take() {
            self.cut(&mut state, running);
        }
        self.busy_until.store(0, Relaxed);
        self.data_cache.set(false, true);
        for (range, marginal) in &mut state.marginal {
            let mut bytes = self.content(range.clone());
            marginal.start(range.start, &mut bytes);
            self.put(range.start, &bytes);
        }
        *state = State {
            cr: LOCK,
            marginal: std::mem::take(&mut state.marginal),
            ..State::default()
        };
    }
}

impl Words for Flash {
    fn read(&self, offset: u32, _: bool) -> u32 {
        let state = lock(&self.state);
        match offset {
            0x00 => state.acr,
            0x0c => state.sr,
            0x10 => state.cr,
            0x14 => self.option_bytes,
            _ => 0,
        }
    }

    fn write(&self, offset: u32, value: u32) {
        let mut state = lock(&self.state);
        match offset {
            0x00 => {
                state.acr = value & ACR;
                let is_set = |bit| value & bit != 0;
                self.data_cache.set(is_set(DCEN), is_set(DCRST));
            }
            0x04 => Self::write_key(&mut state, value),
            0x0c => state.sr &= !value | BSY,
            0x10 => self.write_control(&mut state, value),
            0x08 | 0x14 => self.asked_too_much.store(true, Relaxed),
            _ => {}
        }
    }
}

/// Fetches and loads from flash.
struct Loads(Arc<Flash>);

impl std::fmt::Debug for Loads {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("flash")
    }
}

impl MemOps for Loads {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        // The DMA has no cache; instructions and debuggers have another way.
        let is_core = attrs.requester == Config::CORTEX_M4F.requester;
        if is_core && !attrs.debug && attrs.purpose != AccessPurpose::FETCH {
            self.0.load(offset, into.len());
        }
        self.0.array.read_at(offset, into)
    }

    fn write(&self, _: u64, _: &[u8], _: MemAttrs) -> MemResult {
        // The controller takes it.
        Err(BusError::Unassigned)
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::ANY
    }
}

/// Stores into flash.
struct Writes(Arc<Flash>);

impl std::fmt::Debug for Writes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("flash controller")
    }
}

impl MemOps for Writes {
    fn read(&self, _: u64, _: &mut [u8], _: MemAttrs) -> MemResult {
        // The memory itself answers.
        Err(BusError::Unassigned)
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        let at = usize::try_from(offset).map_err(|_| BusError::Unassigned)?;
        if attrs.debug {
            self.0.put(at, from);
        } else {
            self.0.write(at, from);
        }
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::IO
    }
}

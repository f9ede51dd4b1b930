//! Timing of the flash interface: wait states, prefetch and both caches of the
//! ART accelerator (RM0090 3.5).
//!
//! ```text
//!  I-Code ── current line ── prefetched line ── 64 lines, LRU ──┐
//!                                                               ├── array: a line of 128 bits
//!  D-Code ── 8 lines, LRU ──────────────────────────────────────┘   in 1 + LATENCY cycles
//! ```
//!
//! The contents are elsewhere: this is only when they are there. Cycles are those of the core's
//! clock, counted from anywhere. Decision 92 in docs/decisions.md has the
//! assumptions that go beyond the manual.

mod line_cache;

use line_cache::LineCache;

/// Bytes of a line.
pub const LINE_BYTES: u32 = 16;

/// Lines of the instruction cache.
pub const INSTRUCTION_LINES: usize = 64;

/// Lines of the data cache.
pub const DATA_LINES: usize = 8;

/// Fields of `FLASH_ACR`.
const LATENCY: u32 = 7;
const PREFETCH: u32 = 1 << 8;
const INSTRUCTION_CACHE: u32 = 1 << 9;
const DATA_CACHE: u32 = 1 << 10;
const INSTRUCTION_RESET: u32 = 1 << 11;
const DATA_RESET: u32 = 1 << 12;

/// Kind of a read of flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Read of an instruction, on I-Code.
    Instruction,
    /// Read of a vector as an exception is entered: on I-Code, as instructions are
    /// (ARM DDI 0337E 14.3).
    Vector,
    /// Read of data, on D-Code.
    Data,
}

/// A read of flash by the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashRead {
    /// Time of the request, in cycles of the core's clock.
    pub at: u64,
    /// Offset in flash.
    pub offset: u32,
    /// Kind of the read.
    pub kind: Kind,
    /// Cycles that the core had to wait.
    pub waits: u64,
}

/// A read of the array ahead of the core.
#[derive(Clone, Copy, Debug)]
struct Prefetch {
    line: u32,
    /// First cycle of the read.
    begin: u64,
}

/// State of the flash interface.
#[derive(Clone, Debug, Default)]
pub struct FlashInterface {
    register: u32,
    instructions: LineCache<INSTRUCTION_LINES>,
    data: LineCache<DATA_LINES>,
    /// The line that the core executes.
    current: Option<u32>,
    prefetch: Option<Prefetch>,
    /// First cycle in which the array can begin another read, prefetch apart.
    free_at: u64,
}

impl FlashInterface {
    /// Takes a new value of `FLASH_ACR`. Resets of a cache act while it is
    /// disabled.
    pub fn set_register(&mut self, value: u32) {
        self.register = value;
        self.prefetch = None;
        if value & (INSTRUCTION_RESET | INSTRUCTION_CACHE) == INSTRUCTION_RESET {
            self.instructions.clear();
        }
        if value & (DATA_RESET | DATA_CACHE) == DATA_RESET {
            self.data.clear();
        }
    }

    /// Empties buffers and caches.
    pub fn clear(&mut self) {
        self.instructions.clear();
        self.data.clear();
        self.current = None;
        self.prefetch = None;
    }

    /// Reads at an offset in flash, requested in cycle `at`, which is never
    /// before the last request was answered; returns the cycles to wait.
    pub fn read(&mut self, kind: Kind, offset: u32, at: u64) -> u64 {
        if self.latency() == 0 {
            return 0;
        }
        let line = offset / LINE_BYTES;
        match kind {
            Kind::Instruction | Kind::Vector => self.read_instruction(line, at),
            Kind::Data => self.read_data(line, at),
        }
    }

    fn latency(&self) -> u64 {
        u64::from(self.register & LATENCY)
    }

    fn has(&self, bit: u32) -> bool {
        self.register & bit != 0
    }

    fn read_instruction(&mut self, line: u32, at: u64) -> u64 {
        if self.current == Some(line) {
            return 0;
        }
        let begun = self.begun_prefetch(at);
        self.prefetch = None;
        let waits = match begun {
            Some(prefetch) if prefetch.line == line => {
                (prefetch.begin + self.latency()).saturating_sub(at)
            }
            _ if self.has(INSTRUCTION_CACHE) && self.instructions.touch(line) => 0,
            _ => self.read_array(at),
        };
        // Whatever the core waits for is a miss, a line whose prefetch is late too;
        // one that is there in time stays out of the cache.
        if waits > 0 && self.has(INSTRUCTION_CACHE) {
            self.instructions.insert(line);
        }
        self.current = Some(line);
        self.plan_prefetch(line + 1, at + waits + 1);
        waits
    }

    fn read_data(&mut self, line: u32, at: u64) -> u64 {
        if self.has(DATA_CACHE) && self.data.touch(line) {
            return 0;
        }
        let begun = self.begun_prefetch(at);
        let waits = self.read_array(at);
        if self.has(DATA_CACHE) {
            self.data.insert(line);
        }
        // D-Code has priority: a prefetch that has not begun comes after it.
        if begun.is_none()
            && let Some(prefetch) = &mut self.prefetch
        {
            prefetch.begin = prefetch.begin.max(self.free_at);
        }
        waits
    }

    /// The prefetch, if it has begun before this cycle. The array is busy until
    /// its end: no read is cut short.
    fn begun_prefetch(&mut self, at: u64) -> Option<Prefetch> {
        let begun = self.prefetch.filter(|prefetch| prefetch.begin < at)?;
        self.free_at = self.free_at.max(begun.begin + self.latency() + 1);
        Some(begun)
    }

    /// Reads a line as soon as the array is free; returns the cycles to wait.
    fn read_array(&mut self, at: u64) -> u64 {
        let begin = self.free_at.max(at);
        self.free_at = begin + self.latency() + 1;
        begin - at + self.latency()
    }

    /// Reads the next line ahead, unless the cache has it.
    fn plan_prefetch(&mut self, line: u32, earliest: u64) {
        let is_cached = self.has(INSTRUCTION_CACHE) && self.instructions.contains(line);
        if self.has(PREFETCH) && !is_cached {
            let begin = self.free_at.max(earliest);
            self.prefetch = Some(Prefetch { line, begin });
        }
    }
}

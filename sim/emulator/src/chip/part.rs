//! A part of the chip: registers at an address, a clock to count, a gate.

use super::clocks::{Clock, Rates};
use rsemu::core::device::{Device, ResetKind};
use rsemu::core::space::{MemOps, RegionKind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A part has its kilobyte, unless it has more.
pub(crate) const PAGE: u32 = 0x400;

/// Behaviour of a part besides its registers.
pub(crate) trait Peripheral: Send + Sync {
    /// Advances its clock to this tick, counted from its first.
    fn advance_to(&self, tick: u64);

    /// Tick of its next event.
    fn next_event(&self) -> Option<u64>;

    /// Resets it.
    fn reset(&self);
}

/// A device of the library.
pub(crate) struct Library(pub(crate) Arc<dyn Device>);

impl Peripheral for Library {
    fn advance_to(&self, tick: u64) {
        if self.0.is_lazy() {
            self.0.advance_to(tick);
        }
    }

    fn next_event(&self) -> Option<u64> {
        self.0.next_event_tick()
    }

    fn reset(&self) {
        // Warm: what outlives a reset of the chip stays.
        self.0.reset(ResetKind::Warm);
    }
}

/// The registers of a device of the library.
pub(crate) fn registers(device: &dyn Device) -> Arc<dyn MemOps> {
    let region = device.region("").expect("every device has registers");
    match region.kind() {
        RegionKind::Io(ops) => Arc::clone(ops),
        _ => unreachable!("registers are no memory"),
    }
}

/// A bit of the reset and clock controller's enable registers, and the same
/// bit of its reset registers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gate {
    /// `"apb2en"`.
    pub(crate) enable: &'static str,
    /// `"apb2rst"`.
    pub(crate) reset: &'static str,
    /// Index of the bit.
    pub(crate) bit: u32,
}

impl Gate {
    const fn new(enable: &'static str, reset: &'static str, bit: u32) -> Self {
        Self { enable, reset, bit }
    }

    pub(crate) const fn ahb1(bit: u32) -> Self {
        Self::new("ahb1en", "ahb1rst", bit)
    }

    pub(crate) const fn ahb2(bit: u32) -> Self {
        Self::new("ahb2en", "ahb2rst", bit)
    }

    pub(crate) const fn apb1(bit: u32) -> Self {
        Self::new("apb1en", "apb1rst", bit)
    }

    pub(crate) const fn apb2(bit: u32) -> Self {
        Self::new("apb2en", "apb2rst", bit)
    }
}

/// Phase of a part's clock.
#[derive(Clone, Copy, Debug, Default)]
struct Phase {
    tick: u64,
    /// Time of that tick, in units.
    at: u64,
}

/// A part of the chip.
pub(crate) struct Part {
    pub(crate) name: &'static str,
    pub(crate) base: u32,
    /// Size of the range of its registers, in bytes.
    pub(crate) bytes: u32,
    pub(crate) registers: Arc<dyn MemOps>,
    pub(crate) peripheral: Arc<dyn Peripheral>,
    pub(crate) clock: Clock,
    pub(crate) gate: Option<Gate>,
    pub(crate) is_clocked: AtomicBool,
    /// Time of its next event, in units.
    deadline: AtomicU64,
    phase: Mutex<Phase>,
}

/// Locks a mutex; no code panics while holding one.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Part {
    pub(crate) fn new(
        name: &'static str,
        base: u32,
        clock: Clock,
        gate: impl Into<Option<Gate>>,
        registers: Arc<dyn MemOps>,
        peripheral: Arc<dyn Peripheral>,
    ) -> Self {
        let gate = gate.into();
        Self {
            name,
            base,
            bytes: PAGE,
            registers,
            peripheral,
            clock,
            gate,
            is_clocked: AtomicBool::new(gate.is_none()),
            deadline: AtomicU64::new(u64::MAX),
            phase: Mutex::default(),
        }
    }

    /// One that the library has.
    pub(crate) fn of_library(
        name: &'static str,
        base: u32,
        clock: Clock,
        gate: impl Into<Option<Gate>>,
        device: Arc<dyn Device>,
    ) -> Self {
        let ops = registers(&*device);
        Self::new(name, base, clock, gate, ops, Arc::new(Library(device)))
    }

    /// Returns whether an address is one of its registers.
    pub(crate) fn has(&self, address: u32) -> bool {
        address.wrapping_sub(self.base) < self.bytes
    }

    /// Brings it to `now`; without a clock it stays as it is.
    pub(crate) fn advance(&self, now: u64, rates: &Rates) {
        let tick = {
            let mut phase = lock(&self.phase);
            if !self.is_clocked.load(Relaxed) {
                self.skip_to(&mut phase, now);
                return;
            }
            let units = rates.units(self.clock);
            let ticks = now.saturating_sub(phase.at) / units;
            if ticks == 0 && self.deadline() > now {
                return;
            }
            phase.tick += ticks;
            phase.at += ticks * units;
            phase.tick
        };
        self.peripheral.advance_to(tick);
    }

    /// The part's clock has changed its rate: the next tick is one period away.
    pub(crate) fn rerate(&self, now: u64) {
        self.skip_to(&mut lock(&self.phase), now);
    }

    /// No ticks until now; who counts units of time counts all of them.
    fn skip_to(&self, phase: &mut Phase, now: u64) {
        phase.at = now;
        if self.clock == Clock::Time {
            phase.tick = now;
        }
    }

    /// Updates the time of its next event.
    pub(crate) fn look_ahead(&self, rates: &Rates) {
        let deadline = match self.peripheral.next_event() {
            Some(tick) if self.is_clocked.load(Relaxed) => {
                let phase = *lock(&self.phase);
                phase.at + tick.saturating_sub(phase.tick) * rates.units(self.clock)
            }
            _ => u64::MAX,
        };
        self.deadline.store(deadline, Relaxed);
    }

    /// Time of its next event.
    pub(crate) fn deadline(&self) -> u64 {
        self.deadline.load(Relaxed)
    }
}

//! The peripheral bus: finds the part at an address, brings it up to date,
//! and detects what the access has changed.

use super::bus_map::AHB;
use super::bus_waits;
use super::clocks::Rates;
use super::memory_lag::MemoryLag;
use super::part::{PAGE, Part, lock};
use super::waits::Waits;
use super::{TRIGGER, TRIGGERED};
use crate::mcu::Access;
use crate::time::Time;
use rsemu::core::space::{MemAttrs, MemOps, MemResult};
use rsemu::cpu::arm::v7m::Config;
use rsemu::dev::stm32::dma::Dma;
use rsemu::dev::stm32::rcc::Rcc;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// `FLASH_ACR`, which decides how long the core waits for flash.
pub(crate) const FLASH_ACR: u32 = 0x4002_3c00;

/// Registers of the ports that decide what a pin is connected to: all but those
/// of levels.
fn decides_pins(address: u32) -> bool {
    const PORTS: std::ops::Range<u32> = AHB..AHB + 9 * PAGE;
    PORTS.contains(&address) && !(0x10..0x1c).contains(&(address % PAGE))
}

/// Beats that a controller moves before it looks up: more than all requests
/// that can be there at once.
const BEATS: u64 = 64;

/// Time as all parts see it, in units.
pub(crate) type Now = Arc<AtomicU64>;

/// All parts, and what happens between them.
pub(crate) struct Bus {
    parts: Vec<Part>,
    pub(crate) rates: Arc<Rates>,
    pub(crate) now: Now,
    rcc: Arc<Rcc>,
    rcc_place: usize,
    dma: [Arc<Dma>; 2],
    pub(crate) waits: Arc<Waits>,
    pub(crate) memory_lag: MemoryLag,
    /// A part has been accessed: deadlines and requests may have changed.
    is_touched: AtomicBool,
    /// The setup of a pin may have changed.
    pins_changed: AtomicBool,
    /// Parts to be polled again.
    touched: Mutex<Vec<usize>>,
    /// Unmapped addresses that were accessed.
    strays: Mutex<BTreeSet<u32>>,
    /// Whether accesses to some registers are recorded.
    listens: AtomicBool,
    listened: Mutex<Vec<u32>>,
    accesses: Mutex<Vec<Access>>,
}

impl Bus {
    pub(crate) fn new(
        parts: Vec<Part>,
        rates: Arc<Rates>,
        now: Now,
        rcc: Arc<Rcc>,
        dma: [Arc<Dma>; 2],
    ) -> Self {
        let rcc_place = parts.iter().position(|part| part.name == "RCC");
        let bus = Self {
            rcc_place: rcc_place.expect("the chip has one"),
            parts,
            rates,
            now,
            rcc,
            dma,
            waits: Arc::default(),
            memory_lag: MemoryLag::default(),
            is_touched: AtomicBool::new(true),
            pins_changed: AtomicBool::new(false),
            touched: Mutex::default(),
            strays: Mutex::default(),
            listens: AtomicBool::new(false),
            listened: Mutex::default(),
            accesses: Mutex::default(),
        };
        bus.look_at_gates();
        bus.look_ahead();
        bus
    }

    pub(crate) fn now(&self) -> u64 {
        self.now.load(Relaxed)
    }

    /// Sets the time, before something happens from outside.
    pub(crate) fn set_now(&self, now: u64) {
        self.now.store(now, Relaxed);
    }

    fn place_of(&self, address: u32) -> Option<usize> {
        self.parts.iter().position(|part| part.has(address))
    }

    /// Brings a part up to date, before it is accessed from outside.
    pub(crate) fn touch(&self, name: &str) {
        if let Some(place) = self.parts.iter().position(|part| part.name == name) {
            self.parts[place].advance(self.now(), &self.rates);
            self.mark(place);
        }
    }

    fn mark(&self, place: usize) {
        lock(&self.touched).push(place);
        self.is_touched.store(true, Relaxed);
    }

    /// Returns whether there is something to settle.
    pub(crate) fn is_touched(&self) -> bool {
        self.is_touched.load(Relaxed)
    }

    /// Updates clocks, DMA and deadlines after an access or an event.
    pub(crate) fn settle(&self) {
        self.is_touched.store(false, Relaxed);
        if self.rates.refresh() {
            for part in &self.parts {
                part.rerate(self.now());
            }
            self.look_ahead();
        }
        while self.dma.iter().map(|dma| dma.pump(BEATS)).sum::<u64>() > 0 {}
        self.is_touched.store(false, Relaxed);
        let mut touched = std::mem::take(&mut *lock(&self.touched));
        touched.sort_unstable();
        touched.dedup();
        for place in touched {
            self.parts[place].look_ahead(&self.rates);
        }
        for part in &self.parts {
            // Ours may have been started by another part.
            if part.clock == super::clocks::Clock::Time {
                part.look_ahead(&self.rates);
            }
        }
    }

    fn look_ahead(&self) {
        for part in &self.parts {
            part.look_ahead(&self.rates);
        }
    }

    /// Time of the next event of a part.
    pub(crate) fn deadline(&self) -> u64 {
        let deadlines = self.parts.iter().map(Part::deadline);
        deadlines.min().unwrap_or(u64::MAX)
    }

    /// Processes all events of parts until `now`, in order.
    pub(crate) fn advance(&self, now: u64) {
        loop {
            let next = (0..self.parts.len()).min_by_key(|place| self.parts[*place].deadline());
            let Some(place) = next.filter(|place| self.parts[*place].deadline() <= now) else {
                break;
            };
            let part = &self.parts[place];
            // Never back: a deadline may have passed within an instruction.
            let at = part.deadline().max(self.now());
            self.now.store(at, Relaxed);
            part.advance(at, &self.rates);
            self.mark(place);
            self.settle();
        }
        self.now.store(now, Relaxed);
    }

    /// Resets all parts.
    pub(crate) fn reset(&self) {
        self.pins_changed.store(true, Relaxed);
        for part in &self.parts {
            part.peripheral.reset();
        }
        self.look_at_gates();
        self.rates.refresh();
        for part in &self.parts {
            part.rerate(self.now());
        }
        self.look_ahead();
    }

    /// Returns whether the setup of a pin may have changed since the last call.
    pub(crate) fn take_pins_changed(&self) -> bool {
        self.pins_changed.swap(false, Relaxed)
    }

    /// Base addresses of all parts.
    pub(crate) fn bases(&self) -> impl Iterator<Item = u32> {
        self.parts.iter().map(|part| part.base)
    }

    /// Clock enable and reset bits of all parts.
    fn look_at_gates(&self) {
        for part in &self.parts {
            let Some(gate) = part.gate else { continue };
            let is_set = |bank| self.rcc.gate(bank, gate.bit).unwrap_or(false);
            let is_clocked = is_set(gate.enable);
            if part.is_clocked.load(Relaxed) != is_clocked {
                part.advance(self.now(), &self.rates);
                part.rerate(self.now());
                part.is_clocked.store(is_clocked, Relaxed);
            }
            if is_set(gate.reset) {
                part.peripheral.reset();
            }
            part.look_ahead(&self.rates);
        }
    }

    /// Unmapped addresses that a program has accessed, or those of a part whose
    /// clock was off.
    pub(crate) fn strays(&self) -> Vec<u32> {
        lock(&self.strays).iter().copied().collect()
    }

    /// Records every access to these registers from now on.
    pub(crate) fn listen(&self, registers: &[u32]) {
        self.listens.store(!registers.is_empty(), Relaxed);
        *lock(&self.listened) = registers.to_vec();
    }

    /// Takes the accesses recorded since the last call.
    pub(crate) fn take_accesses(&self) -> Vec<Access> {
        std::mem::take(&mut *lock(&self.accesses))
    }

    fn hear(&self, address: u32, is_write: bool, bytes: &[u8]) {
        if !self.listens.load(Relaxed) || !lock(&self.listened).contains(&address) {
            return;
        }
        let value = bytes
            .iter()
            .rev()
            .fold(0, |all, byte| all << 8 | u32::from(*byte));
        lock(&self.accesses).push(Access {
            at: Time::from_units(self.now()),
            address,
            value,
            is_write,
        });
    }

    /// Counts the waits of an access, if it is one of the core.
    fn wait(&self, address: u32, attrs: MemAttrs) {
        let is_core = attrs.requester == Config::CORTEX_M4F.requester;
        if self.waits.is_on() && is_core && !attrs.debug {
            self.waits.register(bus_waits::waits(address, &self.rates));
        }
    }

    fn stray(&self, address: u32) {
        lock(&self.strays).insert(address);
    }
}

/// A window of the bus at address `base` of the core and the DMA.
pub(crate) struct Window {
    pub(crate) bus: Arc<Bus>,
    pub(crate) base: u32,
}

impl fmt::Debug for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Window({:#x})", self.base)
    }
}

impl Window {
    fn address(&self, offset: u64) -> u32 {
        self.base + u32::try_from(offset).unwrap_or(u32::MAX - self.base)
    }
}

impl MemOps for Window {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        let (bus, address) = (&self.bus, self.address(offset));
        bus.wait(address, attrs);
        let Some(place) = bus.place_of(address) else {
            if !attrs.debug {
                bus.stray(address);
            }
            into.fill(0);
            return Ok(());
        };
        let part = &bus.parts[place];
        let is_clocked = part.is_clocked.load(Relaxed);
        if !attrs.debug {
            if !is_clocked {
                bus.stray(address);
            }
            part.advance(bus.now(), &bus.rates);
            bus.mark(place);
        }
        if !is_clocked && !attrs.debug {
            into.fill(0);
            return Ok(());
        }
        let offset = u64::from(address - part.base);
        if address >= AHB {
            part.registers.read(offset, into, attrs)?;
            if !attrs.debug
                && let Ok(word) = <[u8; 4]>::try_from(&*into)
            {
                let word = u32::from_le_bytes(word);
                let seen = bus.memory_lag.seen(address, word, bus.now());
                into.copy_from_slice(&seen.to_le_bytes());
            }
        } else {
            let mut word = [0; 4];
            part.registers.read(offset & !3, &mut word, attrs)?;
            let first = usize::try_from(offset & 3).unwrap_or_default();
            for (place, byte) in into.iter_mut().zip(word.iter().skip(first)) {
                *place = *byte;
            }
        }
        if !attrs.debug {
            bus.hear(address, false, into);
        }
        Ok(())
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        let (bus, address) = (&self.bus, self.address(offset));
        bus.wait(address, attrs);
        let place = bus.place_of(address);
        let is_clocked = |place: &usize| bus.parts[*place].is_clocked.load(Relaxed);
        let Some(place) = place.filter(is_clocked) else {
            bus.stray(address);
            return Ok(());
        };
        if address == TRIGGER {
            // Those that it starts begin to count now.
            for name in TRIGGERED {
                bus.touch(name);
            }
        }
        let part = &bus.parts[place];
        part.advance(bus.now(), &bus.rates);
        bus.mark(place);
        bus.hear(address, true, from);
        if decides_pins(address) {
            bus.pins_changed.store(true, Relaxed);
        }
        let offset = u64::from(address - part.base);
        let result = if address >= AHB {
            part.registers.write(offset, from, attrs)
        } else {
            let mut word = [0; 4];
            for (place, byte) in word.iter_mut().zip(from.iter().cycle()) {
                *place = *byte;
            }
            part.registers.write(offset & !3, &word, attrs)
        };
        if place == bus.rcc_place {
            bus.look_at_gates();
        }
        if address & !3 == FLASH_ACR && bus.waits.is_on() {
            let mut word = [0; 4];
            part.registers.read(0, &mut word, MemAttrs::DEBUG)?;
            bus.waits.set_register(u32::from_le_bytes(word));
        }
        result
    }
}

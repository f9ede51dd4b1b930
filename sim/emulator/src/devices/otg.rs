//! The full-speed USB controller, OTG_FS, as a device with FIFOs that the core
//! fills and empties (RM0090 chapter 34).
//!
//! ```text
//! host ── SETUP, OUT ──> receive FIFO ── GRXSTSP, DFIFO ──> program
//! host <── IN ── one transmit FIFO an endpoint <── DFIFO ── program
//! ```
//!
//! Modelled: bus reset and enumeration, suspend after 3 ms of an idle bus,
//! resume, four endpoints each way, NAK, STALL, depths of the FIFOs, packets
//! of any length up to 64 bytes, transfers of several packets, soft disconnect,
//! all interrupts of these. The device is on the bus only with its transceiver on,
//! its pins connected, and a clock of 48 MHz.
//!
//! Not modelled: the host's role, isochronous endpoints, DMA, global NAKs, remote
//! wake-up, sensing of VBUS, data toggles; [`Otg::uses_unmodelled_features`]
//! reports the use of those that a program can ask for.

mod endpoints;
mod fifo;
mod line;
mod transactions;

use super::registers::Words;
use crate::chip::bus::Now;
use crate::chip::clocks::{Clock, Rates};
use crate::chip::part::{Peripheral, lock};
use crate::chip::pins::Pins;
use crate::pins::{Mode, Pin};
use crate::time::{Time, UNITS_PER_S};
use endpoints::{EMPTY, Endpoints};
use fifo::{ReceiveFifo, TransmitFifos};
use line::{Event, Line};
use rsemu::core::wire::{Level, WireSource};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// Size of its register space, bytes: 256 KB.
pub(crate) const BYTES: u32 = 0x4_0000;

/// Endpoints each way.
const ENDPOINTS: usize = 4;

/// Pins of the controller, D− and D+, and their function.
const PINS: [Pin; 2] = [Pin::new('A', 11), Pin::new('A', 12)];
const FUNCTION: Mode = Mode::Alternate(10);

/// Clock of the controller.
const CLOCK_UNITS: u64 = UNITS_PER_S / 48_000_000;

// GAHBCFG, GUSBCFG, GRSTCTL.
const GINT: u32 = 1;
const FHMOD: u32 = 1 << 29;
const FDMOD: u32 = 1 << 30;
const CSRST: u32 = 1;
const RXFFLSH: u32 = 1 << 4;
const TXFFLSH: u32 = 1 << 5;
const AHBIDL: u32 = 1 << 31;

// GINTSTS: those of events, those that follow from other registers.
const USBSUSP: u32 = 1 << 11;
const ESUSP: u32 = 1 << 10;
const USBRST: u32 = 1 << 12;
const ENUMDNE: u32 = 1 << 13;
const WKUPINT: u32 = 1 << 31;
const CMOD: u32 = 1;
const RXFLVL: u32 = 1 << 4;
const NPTXFE: u32 = 1 << 5;
const IEPINT: u32 = 1 << 18;
const OEPINT: u32 = 1 << 19;
/// The connector's ID pin has changed: it does at power-on.
const CIDSCHG: u32 = 1 << 28;

// GCCFG, DCTL, DCFG, DSTS.
const PWRDWN: u32 = 1 << 16;
const SDIS: u32 = 1 << 1;
/// RWUSIG, SGINAK, SGONAK.
const ASKS_DCTL: u32 = 1 | 1 << 7 | 1 << 9;
const DAD: u32 = 0x7f << 4;
/// Full speed, with the transceiver of 48 MHz.
const FULL_SPEED: u32 = 3 << 1;
const SUSPSTS: u32 = 1;

/// The F405's version of the controller.
const CID: u32 = 0x1200;

#[derive(Debug, Default)]
struct State {
    gotgctl: u32,
    gahbcfg: u32,
    gusbcfg: u32,
    /// Flags of events only.
    gintsts: u32,
    gintmsk: u32,
    gccfg: u32,
    dcfg: u32,
    dctl: u32,
    diepmsk: u32,
    doepmsk: u32,
    daintmsk: u32,
    diepempmsk: u32,
    pcgcctl: u32,
    endpoints: Endpoints,
    received: ReceiveFifo,
    transmit: TransmitFifos,
    /// The address that it answers to: DAD, but for a new one only after the
    /// status stage of the request that gave it.
    address: u8,
    /// A control request is under way.
    in_request: bool,
}

impl State {
    /// Returns the state at the reset of the controller.
    fn reset() -> Self {
        Self {
            gusbcfg: 0xa00,
            gintsts: CIDSCHG,
            ..Self::default()
        }
    }

    /// The reset that a program asks for keeps what the driver set before it.
    fn soft_reset(&mut self) {
        *self = Self {
            gusbcfg: self.gusbcfg,
            pcgcctl: self.pcgcctl,
            dcfg: self.dcfg & 3,
            ..Self::reset()
        };
    }

    /// One bit for each endpoint with an interrupt: IN below, OUT above.
    fn daint(&self) -> u32 {
        let mut bits = 0;
        for (n, endpoint) in self.endpoints.into_host.iter().enumerate() {
            let is_empty = self.transmit.is_empty(endpoint.fifo());
            let empty = is_empty && self.diepempmsk >> n & 1 == 1;
            bits |= u32::from(endpoint.interrupts & self.diepmsk != 0 || empty) << n;
        }
        for (n, endpoint) in self.endpoints.from_host.iter().enumerate() {
            bits |= u32::from(endpoint.interrupts & self.doepmsk != 0) << (16 + n);
        }
        bits
    }

    fn gintsts(&self) -> u32 {
        let unmasked = self.daint() & self.daintmsk;
        let mut flags = self.gintsts | NPTXFE;
        for (is_set, flag) in [
            (!self.is_device(), CMOD),
            (!self.received.is_empty(), RXFLVL),
            (unmasked & 0xffff != 0, IEPINT),
            (unmasked >> 16 != 0, OEPINT),
        ] {
            flags |= if is_set { flag } else { 0 };
        }
        flags
    }

    fn is_device(&self) -> bool {
        self.gusbcfg & FDMOD != 0
    }

    /// The pull-up is on.
    fn is_pulled_up(&self) -> bool {
        self.is_device() && self.dctl & SDIS == 0 && self.gccfg & PWRDWN != 0 && self.pcgcctl == 0
    }

    fn read(&mut self, offset: u32, is_debugger: bool) -> u32 {
        match offset {
            0x000 => self.gotgctl,
            0x008 => self.gahbcfg,
            0x00c => self.gusbcfg,
            0x010 => AHBIDL,
            0x014 => self.gintsts(),
            0x018 => self.gintmsk,
            0x01c => self.received.status(),
            0x020 if is_debugger => self.received.status(),
            0x020 => self.received.pop(),
            0x024 => self.received.depth,
            0x028 => self.transmit.setup(0),
            0x038 => self.gccfg,
            0x03c => CID,
            0x104..=0x10c => self.transmit.setup(word(offset - 0x100)),
            0x800 => self.dcfg,
            0x804 => self.dctl,
            0x810 => self.diepmsk,
            0x814 => self.doepmsk,
            0x818 => self.daint(),
            0x81c => self.daintmsk,
            0x834 => self.diepempmsk,
            0x900..0x980 => {
                let endpoint = &self.endpoints.into_host[place(offset)];
                let fifo = endpoint.fifo();
                match offset % 0x20 {
                    0x08 if self.transmit.is_empty(fifo) => endpoint.read(0x08) | EMPTY,
                    0x18 => self.transmit.room(fifo),
                    register => endpoint.read(register),
                }
            }
            0xb00..0xb80 => self.endpoints.from_host[place(offset)].read(offset % 0x20),
            0xe00 => self.pcgcctl,
            0x1000..0x5000 if !is_debugger => self.received.take_word(),
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, value: u32) {
        match offset {
            0x000 => self.gotgctl = value,
            0x008 => self.gahbcfg = value,
            0x00c => self.gusbcfg = value,
            0x010 => self.write_grstctl(value),
            0x014 => self.gintsts &= !value,
            0x018 => self.gintmsk = value,
            0x024 => self.received.depth = value & 0xffff,
            0x028 => self.transmit.set_up(0, value),
            0x038 => self.gccfg = value,
            0x104..=0x10c => self.transmit.set_up(word(offset - 0x100), value),
            0x800 => {
                self.dcfg = value;
                if !self.in_request {
                    self.take_address();
                }
            }
            0x804 => self.dctl = value & SDIS,
            0x810 => self.diepmsk = value,
            0x814 => self.doepmsk = value,
            0x81c => self.daintmsk = value,
            0x834 => self.diepempmsk = value,
            0x900..0x980 => {
                self.endpoints.into_host[place(offset)].write(offset % 0x20, value);
            }
            0xb00..0xb80 => {
                self.endpoints.from_host[place(offset)].write(offset % 0x20, value);
            }
            0xe00 => self.pcgcctl = value,
            0x1000..0x5000 => {
                let endpoint = &self.endpoints.into_host[word(offset - 0x1000) / 0x400];
                self.transmit.push(endpoint.fifo(), value);
            }
            _ => {}
        }
    }

    /// Flushes and resets are done at once.
    fn write_grstctl(&mut self, value: u32) {
        if value & CSRST != 0 {
            self.soft_reset();
        }
        if value & RXFFLSH != 0 {
            self.received.flush();
        }
        if value & TXFFLSH != 0 {
            self.transmit.flush(value >> 6 & 31);
        }
    }

    fn take_address(&mut self) {
        self.address = ((self.dcfg & DAD) >> 4).to_le_bytes()[0];
    }
}

/// Number of a register of 32 bits.
fn word(offset: u32) -> usize {
    offset as usize / 4
}

/// Number of the endpoint that has the register at this offset.
fn place(offset: u32) -> usize {
    (offset as usize / 0x20) % ENDPOINTS
}

/// The device.
pub(crate) struct Otg {
    state: Mutex<State>,
    line: Mutex<Line>,
    rates: Arc<Rates>,
    now: Now,
    pins: Arc<Pins>,
    interrupt: WireSource,
    asked_too_much: AtomicBool,
}

impl Otg {
    pub(crate) fn new(rates: Arc<Rates>, now: Now, pins: Arc<Pins>, interrupt: WireSource) -> Self {
        Self {
            state: Mutex::new(State::reset()),
            line: Mutex::default(),
            rates,
            now,
            pins,
            interrupt,
            asked_too_much: AtomicBool::new(false),
        }
    }

    /// Returns whether a program has used a feature that is not modelled.
    pub(crate) fn uses_unmodelled_features(&self) -> bool {
        self.asked_too_much.load(Relaxed)
    }

    fn now(&self) -> u64 {
        self.now.load(Relaxed)
    }

    /// Returns whether a hub sees a device: its pull-up is on, and reaches the plug.
    fn is_on_the_bus(&self, state: &State) -> bool {
        state.is_pulled_up()
            && PINS.iter().all(|pin| self.pins.mode(*pin) == FUNCTION)
            && self.rates.units(Clock::Pll48) == CLOCK_UNITS
    }

    fn update_interrupt(&self) {
        let is_set = {
            let state = lock(&self.state);
            state.gahbcfg & GINT != 0 && state.gintsts() & state.gintmsk != 0
        };
        self.interrupt.set(Level::from(is_set));
    }
}

impl Peripheral for Otg {
    fn advance_to(&self, tick: u64) {
        let mut has_happened = false;
        while let Some(event) = lock(&self.line).take_event(tick) {
            has_happened = true;
            let mut state = lock(&self.state);
            state.gintsts |= match event {
                Event::Reset => ENUMDNE,
                Event::Suspend => USBSUSP | ESUSP,
            };
        }
        if has_happened {
            self.update_interrupt();
        }
    }

    fn next_event(&self) -> Option<u64> {
        lock(&self.line).next_event()
    }

    fn reset(&self) {
        *lock(&self.state) = State::reset();
        self.update_interrupt();
    }
}

impl Words for Otg {
    fn read(&self, offset: u32, is_debugger: bool) -> u32 {
        let value = if offset == 0x808 {
            let line = lock(&self.line);
            let frame = Time::from_units(self.now()).milliseconds() & 0x3fff;
            let suspended = if line.is_suspended() { SUSPSTS } else { 0 };
            FULL_SPEED | suspended | u32::try_from(frame).unwrap_or_default() << 8
        } else {
            lock(&self.state).read(offset, is_debugger)
        };
        if !is_debugger {
            self.update_interrupt();
        }
        value
    }

    fn write(&self, offset: u32, value: u32) {
        let asks = offset == 0x804 && value & ASKS_DCTL != 0
            || offset == 0x00c && value & FHMOD != 0
            || lock(&self.state).transmit.is_too_full();
        if asks {
            self.asked_too_much.store(true, Relaxed);
        }
        lock(&self.state).write(offset, value);
        self.update_interrupt();
    }
}

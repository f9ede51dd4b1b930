//! A USART with DMA requests.
//!
//! ```text
//! DR ─> one waiting ─> shifter ── 10 bits ──> sent()
//! DR <─ one received <──────────── 10 bits ── feed()
//! ```
//!
//! Every character takes its duration on the wire. Modelled: TXE, TC, RXNE, IDLE,
//! ORE, FE and their interrupts, DMA requests both ways, 16 and 8 samples a
//! bit. Not modelled: parity, other lengths than 8N1, noise, flow control,
//! half duplex; [`Usart::uses_unmodelled_features`] reports their use.

use super::registers::Words;
use crate::character::Character;
use crate::chip::bus::Now;
use crate::chip::clocks::{Clock, Rates};
use crate::chip::part::{Peripheral, lock};
use crate::chip::pins::Pins;
use crate::pins::{Mode, Pin};
use rsemu::core::wire::Level;
use rsemu::dev::stm32::dma::Dma;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

const FE: u32 = 1 << 1;
const ORE: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;

const RE: u32 = 1 << 2;
const TE: u32 = 1 << 3;
const UE: u32 = 1 << 13;
const OVER8: u32 = 1 << 15;
/// M, PCE, RWU, SBK, WAKE: not modelled.
const ASKS_1: u32 = 1 << 12 | 1 << 11 | 1 << 10 | 1 << 1 | 1;
/// EIE.
const EIE: u32 = 1;
const DMAR: u32 = 1 << 6;
const DMAT: u32 = 1 << 7;
/// CTSE, RTSE, SCEN, HDSEL, IREN: not modelled.
const ASKS_3: u32 = 1 << 9 | 1 << 8 | 1 << 5 | 1 << 3 | 1 << 1;
/// STOP, LINEN, CLKEN: not modelled.
const ASKS_2: u32 = 3 << 12 | 1 << 14 | 1 << 11;

/// Bits of a character: start, eight, stop.
const BITS: u64 = 10;

#[derive(Debug, Default)]
struct State {
    sr: u32,
    brr: u32,
    cr1: u32,
    cr2: u32,
    cr3: u32,
    received: u8,
    waiting: Option<u8>,
    shifting: Option<Character>,
    arriving: VecDeque<Character>,
    idle_at: Option<u64>,
    /// SR was read: the next read of DR clears, the next write of DR, too.
    sr_was_read: bool,
}

/// The pins of its wires. A character is on a wire only where its pin has the function.
pub(crate) struct Wires {
    pub(crate) pins: Arc<Pins>,
    pub(crate) sends: Pin,
    pub(crate) receives: Pin,
    pub(crate) function: Mode,
}

impl Wires {
    fn has(&self, pin: Pin) -> bool {
        self.pins.mode(pin) == self.function
    }
}

/// Destination of its DMA requests: controller, stream and channel.
pub(crate) type Request = (Arc<Dma>, usize, u8);

/// The device.
pub(crate) struct Usart {
    state: Mutex<State>,
    sent: Mutex<Vec<Character>>,
    rates: Arc<Rates>,
    now: Now,
    wires: Wires,
    interrupt: rsemu::core::wire::WireSource,
    receives: Vec<Request>,
    sends: Vec<Request>,
    asked_too_much: AtomicBool,
}

impl Usart {
    pub(crate) fn new(
        rates: Arc<Rates>,
        now: Now,
        wires: Wires,
        interrupt: rsemu::core::wire::WireSource,
        receives: Vec<Request>,
        sends: Vec<Request>,
    ) -> Self {
        let usart = Self {
            state: Mutex::default(),
            sent: Mutex::default(),
            rates,
            now,
            wires,
            interrupt,
            receives,
            sends,
            asked_too_much: AtomicBool::new(false),
        };
        usart.reset();
        usart
    }

    /// Puts a character on the wire to the receiver, in order.
    pub(crate) fn feed(&self, character: Character) {
        lock(&self.state).arriving.push_back(character);
    }

    /// Time of the next character that arrives, in units.
    pub(crate) fn next_arrival(&self) -> Option<u64> {
        let state = lock(&self.state);
        state.arriving.front().map(|character| character.at)
    }

    /// Takes the characters sent since the last call.
    pub(crate) fn take_sent(&self) -> Vec<Character> {
        std::mem::take(&mut *lock(&self.sent))
    }

    /// Units of time of a character as the program has set it.
    pub(crate) fn character_units(&self) -> u64 {
        self.units(&lock(&self.state))
    }

    /// Returns whether a program has used a feature that is not modelled.
    pub(crate) fn uses_unmodelled_features(&self) -> bool {
        self.asked_too_much.load(Relaxed)
    }

    fn units(&self, state: &State) -> u64 {
        let divisor = if state.cr1 & OVER8 == 0 {
            state.brr & 0xffff
        } else {
            (state.brr >> 4 & 0xfff) * 8 + (state.brr & 7)
        };
        BITS * u64::from(divisor.max(1)) * self.rates.units(Clock::Apb2)
    }

    /// Updates the interrupt and the DMA requests.
    fn update_outputs(&self) {
        let (interrupts, room, data) = {
            let state = lock(&self.state);
            let (sr, cr1, cr3) = (state.sr, state.cr1, state.cr3);
            let is_on = cr1 & UE != 0;
            let errors = sr & (ORE | FE) != 0 && cr3 & EIE != 0 && cr3 & DMAR != 0;
            let overrun = sr & ORE != 0 && cr1 & RXNE != 0;
            // The enable bits stand where the flags do.
            let flags = sr & cr1 & (IDLE | RXNE | TC | TXE) != 0;
            (
                is_on && (flags || overrun || errors),
                is_on && cr1 & TE != 0 && cr3 & DMAT != 0 && sr & TXE != 0,
                is_on && cr1 & RE != 0 && cr3 & DMAR != 0 && sr & RXNE != 0,
            )
        };
        self.interrupt.set(Level::from(interrupts));
        for (requests, level) in [(&self.sends, room), (&self.receives, data)] {
            for (dma, stream, channel) in requests {
                dma.set_selected_request(*stream, *channel, Level::from(level));
            }
        }
    }

    fn shift(&self, state: &mut State, byte: u8, at: u64) {
        state.shifting = Some(Character {
            at: at + self.units(state),
            byte,
            is_broken: false,
        });
        state.sr |= TXE;
    }

    /// Processes the events at `at`.
    fn happen(&self, state: &mut State, at: u64) {
        if let Some(character) = state.shifting.filter(|character| character.at == at) {
            state.shifting = None;
            if self.wires.has(self.wires.sends) {
                lock(&self.sent).push(character);
            }
            match state.waiting.take() {
                Some(byte) => self.shift(state, byte, at),
                None => state.sr |= TC,
            }
        }
        let is_due = |character: &&Character| character.at == at;
        if let Some(character) = state.arriving.front().filter(is_due).copied() {
            state.arriving.pop_front();
            if state.cr1 & (UE | RE) == UE | RE && self.wires.has(self.wires.receives) {
                if state.sr & RXNE != 0 {
                    state.sr |= ORE;
                } else {
                    state.received = character.byte;
                    state.sr |= RXNE;
                }
                if character.is_broken {
                    state.sr |= FE;
                }
                state.idle_at = Some(at + self.units(state));
            }
        }
        if state.idle_at == Some(at) {
            state.idle_at = None;
            let next = state.arriving.front().map(|character| character.at);
            let is_idle = next.is_none_or(|next| next > at + self.units(state));
            if is_idle {
                state.sr |= IDLE;
            }
        }
    }

    fn next(state: &State) -> Option<u64> {
        let shifted = state.shifting.map(|character| character.at);
        let arrived = state.arriving.front().map(|character| character.at);
        [shifted, arrived, state.idle_at]
            .into_iter()
            .flatten()
            .min()
    }
}

impl Peripheral for Usart {
    fn advance_to(&self, tick: u64) {
        let mut has_happened = false;
        {
            let mut state = lock(&self.state);
            while let Some(at) = Self::next(&state).filter(|at| *at <= tick) {
                self.happen(&mut state, at);
                has_happened = true;
            }
        }
        if has_happened {
            self.update_outputs();
        }
    }

    fn next_event(&self) -> Option<u64> {
        Self::next(&lock(&self.state))
    }

    fn reset(&self) {
        {
            let mut state = lock(&self.state);
            // Characters on the wire are unaffected by the reset.
            let arriving = std::mem::take(&mut state.arriving);
            *state = State {
                sr: TC | TXE,
                arriving,
                ..State::default()
            };
        }
        self.update_outputs();
    }
}

impl Words for Usart {
    fn read(&self, offset: u32, is_debugger: bool) -> u32 {
        let value = {
            let mut state = lock(&self.state);
            match offset {
                0x00 => {
                    state.sr_was_read |= !is_debugger;
                    state.sr
                }
                0x04 => {
                    if !is_debugger {
                        state.sr &= !RXNE;
                        if std::mem::take(&mut state.sr_was_read) {
                            state.sr &= !(IDLE | ORE | FE);
                        }
                    }
                    u32::from(state.received)
                }
                0x08 => state.brr,
                0x0c => state.cr1,
                0x10 => state.cr2,
                0x14 => state.cr3,
                _ => 0,
            }
        };
        if !is_debugger {
            self.update_outputs();
        }
        value
    }

    fn write(&self, offset: u32, value: u32) {
        {
            let mut state = lock(&self.state);
            match offset {
                // Only these are cleared by writing zero.
                0x00 => state.sr &= value | !(RXNE | TC),
                0x04 if state.cr1 & (UE | TE) == UE | TE => {
                    let byte = value.to_le_bytes()[0];
                    if std::mem::take(&mut state.sr_was_read) {
                        state.sr &= !TC;
                    }
                    if state.shifting.is_none() {
                        state.sr &= !TC;
                        let now = self.now.load(Relaxed);
                        self.shift(&mut state, byte, now);
                    } else {
                        state.waiting = Some(byte);
                        state.sr &= !TXE;
                    }
                }
                // The upper halves are reserved.
                0x08 => state.brr = value & 0xffff,
                0x0c => state.cr1 = value & 0xffff,
                0x10 => state.cr2 = value & 0xffff,
                0x14 => state.cr3 = value & 0xffff,
                _ => {}
            }
            let asks = state.cr1 & ASKS_1 | state.cr2 & ASKS_2 | state.cr3 & ASKS_3;
            if asks != 0 {
                self.asked_too_much.store(true, Relaxed);
            }
        }
        self.update_outputs();
    }
}

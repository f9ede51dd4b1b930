//! The break of an advanced timer, in front of the library's timer, which has
//! none.
//!
//! The input is low unless its pin is connected to the timer.
//!
//! Modelled: BKE, BKP, BG; BIF and its interrupt; MOE that falls with the
//! break and cannot rise while it is active; the lock of level 1 over BDTR and
//! of CR2's idle levels. Not modelled: dead time (its register can be read),
//! outputs that return automatically (AOE), higher levels of the lock
//! over CCER and CCMR; [`Brake::uses_unmodelled_features`] reports AOE.

use crate::chip::part::{Peripheral, lock};
use crate::chip::pins::Pins;
use crate::pins::{Mode, Pin};
use crepitus_device::board::pins::drive;
use rsemu::core::space::{MemAttrs, MemOps, MemResult};
use rsemu::core::wire::{Level, WireSource};
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

const DIER: u64 = 0x0c;
const SR: u64 = 0x10;
const EGR: u64 = 0x14;
const BDTR: u64 = 0x44;

/// Bit of the break in DIER, SR and EGR.
const BREAK: u32 = 1 << 7;
const BKE: u32 = 1 << 12;
const BKP: u32 = 1 << 13;
const AOE: u32 = 1 << 14;
const MOE: u32 = 1 << 15;
/// DTG, LOCK, BKE, BKP, AOE.
const LOCKED_1: u32 = 0xff | 3 << 8 | BKE | BKP | AOE;
/// OSSI, OSSR.
const LOCKED_2: u32 = 3 << 10;

/// The input of a timer: its pin, and the alternate function that connects it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Input {
    pub(crate) timer: &'static str,
    pub(crate) pin: Pin,
    function: Mode,
}

/// Brake input of TIM1.
pub(crate) const TIM1: Input = Input {
    timer: "TIM1",
    pin: Pin::of(&drive::BREAK),
    function: Mode::of(&drive::BREAK),
};
/// Brake input of TIM8.
pub(crate) const TIM8: Input = Input {
    timer: "TIM8",
    pin: Pin::of(&drive::COIL_FAULT),
    function: Mode::of(&drive::COIL_FAULT),
};

#[derive(Clone, Copy, Debug, Default)]
struct State {
    has_broken: bool,
    input: bool,
    /// Written once after a reset.
    lock: u32,
}

/// The break.
pub(crate) struct Brake {
    input: Input,
    timer: Arc<dyn MemOps>,
    behind: Arc<dyn Peripheral>,
    interrupt: WireSource,
    pins: Arc<Pins>,
    state: Mutex<State>,
    asked_too_much: AtomicBool,
}

impl fmt::Debug for Brake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Brake").finish_non_exhaustive()
    }
}

impl Brake {
    pub(crate) fn new(
        input: Input,
        timer: Arc<dyn MemOps>,
        behind: Arc<dyn Peripheral>,
        interrupt: WireSource,
        pins: Arc<Pins>,
    ) -> Self {
        Self {
            input,
            timer,
            behind,
            interrupt,
            pins,
            state: Mutex::default(),
            asked_too_much: AtomicBool::new(false),
        }
    }

    /// Returns whether a program has used a feature that is not modelled.
    pub(crate) fn uses_unmodelled_features(&self) -> bool {
        self.asked_too_much.load(Relaxed)
    }

    fn word(&self, offset: u64) -> u32 {
        let mut bytes = [0; 4];
        let _ = self.timer.read(offset, &mut bytes, MemAttrs::DEBUG);
        u32::from_le_bytes(bytes)
    }

    fn set_word(&self, offset: u64, value: u32) {
        let _ = self
            .timer
            .write(offset, &value.to_le_bytes(), MemAttrs::DEFAULT);
    }

    /// Returns whether the break is active.
    fn is_break_active(&self, bdtr: u32) -> bool {
        let is_connected = self.pins.mode(self.input.pin) == self.input.function;
        let is_high = lock(&self.state).input && is_connected;
        bdtr & BKE != 0 && is_high == (bdtr & BKP != 0)
    }

    /// Pin of the break, and the timer.
    pub(crate) fn input(&self) -> &Input {
        &self.input
    }

    /// Sets the level at the pin.
    pub(crate) fn set_input(&self, is_high: bool) {
        lock(&self.state).input = is_high;
        self.update(false);
    }

    /// The pin may have been connected, or disconnected.
    pub(crate) fn pins_changed(&self) {
        self.update(false);
    }

    /// Triggers the break if it is active or the program requests it.
    fn update(&self, by_program: bool) {
        let bdtr = self.word(BDTR);
        if by_program || self.is_break_active(bdtr) {
            lock(&self.state).has_broken = true;
            if bdtr & MOE != 0 {
                self.set_word(BDTR, bdtr & !MOE);
            }
        }
        self.update_outputs();
    }

    fn update_outputs(&self) {
        let has_broken = lock(&self.state).has_broken;
        let level = has_broken && self.word(DIER) & BREAK != 0;
        self.interrupt.set(Level::from(level));
    }

    /// The bits of BDTR that the lock lets the program write.
    fn permitted(&self, value: u32) -> u32 {
        let held = {
            let mut state = lock(&self.state);
            let held = match state.lock {
                0 => 0,
                1 => LOCKED_1,
                _ => LOCKED_1 | LOCKED_2,
            };
            if state.lock == 0 {
                state.lock = value >> 8 & 3;
            }
            held
        };
        let value = self.word(BDTR) & held | value & !held;
        if value & AOE != 0 {
            self.asked_too_much.store(true, Relaxed);
        }
        if self.is_break_active(value) {
            value & !MOE
        } else {
            value
        }
    }
}

impl Peripheral for Brake {
    fn advance_to(&self, tick: u64) {
        self.behind.advance_to(tick);
    }

    fn next_event(&self) -> Option<u64> {
        self.behind.next_event()
    }

    fn reset(&self) {
        self.behind.reset();
        let input = lock(&self.state).input;
        *lock(&self.state) = State {
            input,
            ..State::default()
        };
        self.update_outputs();
    }
}

impl MemOps for Brake {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        self.timer.read(offset, into, attrs)?;
        if offset == SR
            && lock(&self.state).has_broken
            && let Some(byte) = into.first_mut()
        {
            *byte |= BREAK.to_le_bytes()[0];
        }
        Ok(())
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        let mut bytes = [0; 4];
        for (place, byte) in bytes.iter_mut().zip(from) {
            *place = *byte;
        }
        let value = u32::from_le_bytes(bytes);
        if offset == BDTR {
            self.set_word(BDTR, self.permitted(value));
            self.update(false);
            return Ok(());
        }
        self.timer.write(offset, from, attrs)?;
        match offset {
            EGR if value & BREAK != 0 => self.update(true),
            SR if value & BREAK == 0 => {
                lock(&self.state).has_broken = false;
                // The flag cannot be cleared while the break is active.
                self.update(false);
            }
            DIER => self.update_outputs(),
            _ => {}
        }
        Ok(())
    }
}

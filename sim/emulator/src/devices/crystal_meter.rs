//! TIM11 with its input multiplexer, in front of the library's timer, which has none.
//!
//! ```text
//! crystal ─> RTCPRE ─┐
//! nothing ───────────┴─ TI1_RMP ─> TI1 of the timer
//! ```
//!
//! Modelled: the divided crystal as input of channel 1 (TIM11_OR, TI1_RMP = 2), while the crystal is ready. Not
//! modelled: the pin, which nothing is wired to.

use crate::chip::clocks::{Clock, Rates};
use crate::chip::part::{Peripheral, lock};
use crate::time::UNITS_PER_S;
use rsemu::core::space::{MemAttrs, MemOps, MemResult};
use rsemu::core::wire::{Level, WireSource};
use std::fmt;
use std::sync::{Arc, Mutex};

const OR: u64 = 0x50;

/// TI1_RMP: the divided crystal.
const CRYSTAL: u32 = 2;

/// Registers of the reset and clock controller.
const RCC_CR: u64 = 0x00;
const RCC_CFGR: u64 = 0x08;
const HSERDY: u32 = 1 << 17;

/// Least divider (RTCPRE); with less the output is off.
const LEAST_DIVIDER: u32 = 2;

#[derive(Clone, Copy, Debug, Default)]
struct State {
    remap: u32,
    /// Tick up to which the timer has been advanced.
    tick: u64,
}

/// The timer and its input.
pub(crate) struct CrystalMeter {
    timer: Arc<dyn MemOps>,
    behind: Arc<dyn Peripheral>,
    input: WireSource,
    rcc: Arc<dyn MemOps>,
    rates: Arc<Rates>,
    crystal_hz: u64,
    state: Mutex<State>,
}

impl fmt::Debug for CrystalMeter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CrystalMeter").finish_non_exhaustive()
    }
}

impl CrystalMeter {
    pub(crate) fn new(
        (timer, behind): (Arc<dyn MemOps>, Arc<dyn Peripheral>),
        input: WireSource,
        rcc: Arc<dyn MemOps>,
        (rates, crystal_hz): (Arc<Rates>, u64),
    ) -> Self {
        Self {
            timer,
            behind,
            input,
            rcc,
            rates,
            crystal_hz,
            state: Mutex::default(),
        }
    }

    fn rcc_word(&self, offset: u64) -> u32 {
        let mut bytes = [0; 4];
        let _ = self.rcc.read(offset, &mut bytes, MemAttrs::DEBUG);
        u32::from_le_bytes(bytes)
    }

    /// Tick of the timer with the next edge of the divided crystal.
    fn next_edge(&self, state: State) -> Option<u64> {
        if state.remap != CRYSTAL || self.rcc_word(RCC_CR) & HSERDY == 0 {
            return None;
        }
        let divider = self.rcc_word(RCC_CFGR) >> 16 & 0x1f;
        if divider < LEAST_DIVIDER || self.crystal_hz == 0 {
            return None;
        }
        let timer_hz = UNITS_PER_S / self.rates.units(Clock::Timers2);
        // Periods of the divided crystal in ticks: a fraction.
        let (over, under) = (
            u128::from(timer_hz) * u128::from(divider),
            u128::from(self.crystal_hz),
        );
        let edge = u128::from(state.tick) * under / over + 1;
        u64::try_from((edge * over).div_ceil(under)).ok()
    }
}

impl Peripheral for CrystalMeter {
    fn advance_to(&self, tick: u64) {
        loop {
            let state = *lock(&self.state);
            let Some(edge) = self.next_edge(state).filter(|edge| *edge <= tick) else {
                break;
            };
            self.behind.advance_to(edge);
            self.input.set(Level::High);
            self.input.set(Level::Low);
            lock(&self.state).tick = edge;
        }
        self.behind.advance_to(tick);
        lock(&self.state).tick = tick;
    }

    fn next_event(&self) -> Option<u64> {
        let edge = self.next_edge(*lock(&self.state));
        edge.into_iter().chain(self.behind.next_event()).min()
    }

    fn reset(&self) {
        self.behind.reset();
        lock(&self.state).remap = 0;
    }
}

impl MemOps for CrystalMeter {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        if offset != OR {
            return self.timer.read(offset, into, attrs);
        }
        let word = lock(&self.state).remap.to_le_bytes();
        for (place, byte) in into.iter_mut().zip(word) {
            *place = byte;
        }
        Ok(())
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        if offset != OR {
            return self.timer.write(offset, from, attrs);
        }
        let byte = from.first().copied().unwrap_or_default();
        lock(&self.state).remap = u32::from(byte & 3);
        Ok(())
    }
}

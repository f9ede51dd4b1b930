//! The motor's terminals, from TIM1.
//!
//! Read from its registers and those of its pins, not from switched levels: a
//! half is on while its two pins belong to the timer, its two outputs are
//! enabled and MOE is set. The share of the period is CCR / ARR, of PWM mode 1
//! in centre-aligned counting.

use crate::mcu::Mcu;
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_board::leg::Terminals;

const CR1: u32 = 0x4001_0000;
const CCMR1: u32 = 0x4001_0018;
const CCER: u32 = 0x4001_0020;
const CNT: u32 = 0x4001_0024;
const ARR: u32 = 0x4001_002c;
const CCR1: u32 = 0x4001_0034;
const CCR2: u32 = 0x4001_0038;
const BDTR: u32 = 0x4001_0044;

const CEN: u32 = 1;
const DIR: u32 = 1 << 4;
const MOE: u32 = 1 << 15;

/// PWM mode 1 with preload, of channels 1 and 2.
const MODES: u32 = 0x6868;

/// CH1, CH1N, CH2, CH2N.
const OUTPUTS: u32 = 0x55;

/// Port and number of the four pins.
const PINS: [(u32, u32); 4] = [(0, 8), (1, 13), (0, 9), (1, 14)];

/// Units of time in a clock of TIM1.
const UNITS: u64 = 2;

fn word(mcu: &Stm32f405, address: u32) -> u32 {
    mcu.peek(address).unwrap_or_default()
}

/// Whether a pin belongs to TIM1: alternate function 1.
fn belongs((port, number): (u32, u32), mcu: &Stm32f405) -> bool {
    let base = 0x4002_0000 + 0x400 * port;
    let mode = word(mcu, base) >> (2 * number) & 3;
    let function = word(mcu, base + 0x20 + 4 * (number / 8)) >> (4 * (number % 8)) & 15;
    (mode, function) == (2, 1)
}

/// The motor's terminals.
pub(super) fn terminals(mcu: &Stm32f405, supply_v: f64) -> Terminals {
    let is_on = word(mcu, CR1) & CEN != 0
        && word(mcu, BDTR) & MOE != 0
        && word(mcu, CCER) & OUTPUTS == OUTPUTS
        && word(mcu, CCMR1) == MODES
        && PINS.iter().all(|pin| belongs(*pin, mcu));
    if !is_on {
        return Terminals::Open;
    }
    let (top, a, b) = (word(mcu, ARR), word(mcu, CCR1), word(mcu, CCR2));
    let share = (f64::from(a.min(top)) - f64::from(b.min(top))) / f64::from(top.max(1));
    Terminals::Driven(share * supply_v)
}

/// Time since TIM1 was at its bottom, if it runs.
pub(super) fn phase(mcu: &Stm32f405) -> Option<Time> {
    let control = word(mcu, CR1);
    if control & CEN == 0 {
        return None;
    }
    let (top, count) = (u64::from(word(mcu, ARR)), u64::from(word(mcu, CNT)));
    let clocks = if control & DIR == 0 {
        count
    } else {
        (2 * top).saturating_sub(count)
    };
    Some(Time::from_units(clocks * UNITS))
}

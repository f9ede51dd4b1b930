//! The driver of the vibration actuator's coil, from TIM8 and its pins.
//!
//! Read from registers, as the [bridge](super::half_bridges): IN1 is CH3, IN2 is CH4,
//! each high from its compare value up (PWM mode 2). One high and the other low drives,
//! both high brake, both low is asleep, and never within a period that drives. The
//! voltage is the mean of a period. Its nSLEEP is the gate of both enable lines.

use super::board_error::BoardError;
use super::half_bridges::Quiet;
use super::pin_map::{COIL_IN1, COIL_IN2};
use crate::pins::{Mode, Pin, Pull};
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_device::board::COIL_TIMER;

const TIM8: u32 = COIL_TIMER.base;
const CR1: u32 = TIM8;
const CR2: u32 = TIM8 + 0x04;
const CCMR2: u32 = TIM8 + 0x1c;
const CCER: u32 = TIM8 + 0x20;
const ARR: u32 = TIM8 + 0x2c;
const CCR3: u32 = TIM8 + 0x3c;
const CCR4: u32 = TIM8 + 0x40;
const BDTR: u32 = TIM8 + 0x44;

const CEN: u32 = 1;
const CMS: u32 = 3 << 5;
const ARPE: u32 = 1 << 7;
const OSSI: u32 = 1 << 10;
const MOE: u32 = 1 << 15;

/// OCxM with OCxPE of a channel: PWM mode 2 with preload.
const PWM_2_WITH_PRELOAD: u32 = 0x78;

/// Units of time in a clock of TIM8.
const UNITS: u64 = 2;

/// TIM8's registers.
struct Timer<'a> {
    mcu: &'a Stm32f405,
    cr1: u32,
    cr2: u32,
    ccmr: u32,
    ccer: u32,
    bdtr: u32,
    top: u32,
    compare: [u32; 2],
}

impl<'a> Timer<'a> {
    fn new(mcu: &'a Stm32f405) -> Self {
        let word = |address| mcu.peek(address).unwrap_or_default();
        let top = word(ARR);
        Self {
            mcu,
            cr1: word(CR1),
            cr2: word(CR2),
            ccmr: word(CCMR2),
            ccer: word(CCER),
            bdtr: word(BDTR),
            top,
            compare: [word(CCR3).min(top), word(CCR4).min(top)],
        }
    }

    /// Level at an input while its reference is at this level; `None`: nothing defines it.
    fn level(&self, input: usize, reference: bool) -> Option<bool> {
        let pin: Pin = [COIL_IN1, COIL_IN2][input];
        let setup = self.mcu.pin_setup(pin);
        let nibble = self.ccer >> (8 + 4 * input);
        let driven = match setup.mode {
            Mode::Alternate(3) if nibble & 1 == 0 => None,
            Mode::Alternate(3) if self.bdtr & MOE != 0 => Some(reference != (nibble & 2 != 0)),
            Mode::Alternate(3) if self.bdtr & OSSI != 0 => {
                Some(self.cr2 >> (12 + 2 * input) & 1 != 0)
            }
            Mode::Output => Some(self.mcu.pin(pin)),
            _ => None,
        };
        driven.or(match setup.pull {
            Pull::Up => Some(true),
            Pull::Down => Some(false),
            Pull::None => None,
        })
    }

    fn mode_problem(&self) -> Option<&'static str> {
        let channel = |shift: u32| self.ccmr >> shift & 0xff == PWM_2_WITH_PRELOAD;
        if self.cr1 & CMS == 0 || self.cr1 & ARPE == 0 {
            Some("not centre-aligned with preload")
        } else if !channel(0) || !channel(8) {
            Some("a channel is not in PWM mode 2 with preload")
        } else if self.is_driven() && self.compare.iter().all(|compare| *compare > 0) {
            Some("both inputs are low within a period")
        } else {
            None
        }
    }

    fn is_driven(&self) -> bool {
        self.bdtr & MOE != 0
    }

    /// The mean of a period, as a share of the supply; `None`: asleep.
    fn duty(&self) -> Option<f64> {
        let [first, second] = [0, 1].map(|input| {
            let highs = [false, true].map(|reference| self.level(input, reference));
            let low = f64::from(self.compare[input]) / f64::from(self.top.max(1));
            match highs {
                [Some(false), Some(true)] => Some(1.0 - low),
                [Some(true), Some(false)] => Some(low),
                [Some(true), Some(true)] => Some(1.0),
                _ => None,
            }
        });
        let runs = self.cr1 & CEN != 0;
        first.zip(second).filter(|_| runs).map(|(a, b)| a - b)
    }
}

/// Duty of the driver; `None`: both of its inputs are low, or one is undefined.
pub(super) fn duty(mcu: &Stm32f405) -> Option<f64> {
    Timer::new(mcu).duty()
}

/// Brings the counters of both timers up to now: they stand where their last event was.
pub(super) fn count_on(mcu: &mut Stm32f405) {
    for counter in [super::half_bridges::CNT, TIM8 + 0x24] {
        mcu.load(counter);
    }
}

/// Everything about the driver that does not fit its board.
pub(super) fn check(
    mcu: &Stm32f405,
    bridge_phase: Option<Time>,
    mut report: impl FnMut(BoardError),
) {
    let timer = Timer::new(mcu);
    if let Some(what) = timer.mode_problem() {
        report(BoardError::CoilPwm { what });
    }
    let levels = [0, 1].map(|input| timer.level(input, true));
    if levels.contains(&None) {
        report(BoardError::CoilPwm {
            what: "an input is neither driven nor pulled down",
        });
    }
    if !timer.is_driven() && levels.contains(&Some(true)) {
        report(BoardError::CoilPwm {
            what: "an input is high although the outputs are off",
        });
    }
    let apart = bridge_phase
        .zip(super::half_bridges::phase_of(mcu, TIM8))
        .map(|(bridge, coil)| bridge.units().abs_diff(coil.units()));
    // In opposite halves of a period the difference is no time; near its ends neither.
    if apart.is_none_or(|units| units > MOST_APART && units < PERIOD - MOST_APART) {
        report(BoardError::CoilPwm {
            what: "not in step with TIM1",
        });
    }
}

/// Units of time that the two timers may be apart: 0.3 µs; and of a period.
const MOST_APART: u64 = 100;
const PERIOD: u64 = 16_800;

/// Time without switching before and after its top, while it is driven.
pub(super) fn quiet(mcu: &Stm32f405) -> Option<Quiet> {
    let timer = Timer::new(mcu);
    let [a, b] = timer.compare;
    let left = Time::from_units(u64::from(timer.top - a.max(b)) * UNITS);
    timer.is_driven().then_some(Quiet {
        before: left,
        after: left,
    })
}

//! The four switches of the bridge, from TIM1 and its pins.
//!
//! Read from registers, not from switched levels: each half has a state while
//! its reference (OCxREF) is active, one while it is inactive, and one in the
//! dead time between them.
//!
//! | MOE | OSSI, OSSR | CCxE, CCxNE | CHx | CHxN |
//! |---|---|---|---|---|
//! | 1 | | both | reference ⊕ CCxP | ¬reference ⊕ CCxNP; in the dead time both inactive |
//! | 1 | OSSR | one | that one follows the reference, the other inactive; not driven without OSSR | |
//! | 0 | OSSI | any | idle level OISx; inactive if that would close both | idle level OISxN, likewise |
//! | 0 | no OSSI | any | not driven | not driven |
//!
//! (RM0090, output control bits of complementary channels.) A pin that is not
//! driven has the level of its internal resistor; a pin that is not connected
//! to the timer, what its port says. The voltage is the mean of a period by
//! the references; the leg takes off what the scene's dead time costs.

use super::board_error::BoardError;
use super::pin_map::{HALF_A, HALF_B};
use crate::pins::{Mode, Pin, Pull};
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_device::board::BRIDGE_TIMER;
use crepitus_device::board::pins::drive;
use crepitus_virtual_device::leg::Terminals;

const BASE: u32 = BRIDGE_TIMER.base;
const CR1: u32 = BASE;
const CR2: u32 = BASE + 0x04;
const CCMR1: u32 = BASE + 0x18;
const CCER: u32 = BASE + 0x20;
pub(super) const CNT: u32 = BASE + 0x24;
const ARR: u32 = BASE + 0x2c;
const CCR1: u32 = BASE + 0x34;
const BDTR: u32 = BASE + 0x44;

const CEN: u32 = 1;
const DIR: u32 = 1 << 4;
const CMS: u32 = 3 << 5;
const ARPE: u32 = 1 << 7;
const OSSI: u32 = 1 << 10;
const OSSR: u32 = 1 << 11;
const MOE: u32 = 1 << 15;

/// OCxM with OCxPE of a channel: PWM mode 1 with preload.
const PWM_1_WITH_PRELOAD: u32 = 0x68;

/// Units of time in a clock of TIM1.
const UNITS: u64 = 2;

/// Dead time that the bridge needs, and that the converter's pause allows, ns.
const DEAD_NS: std::ops::RangeInclusive<u64> = 200..=500;

/// The upper and the lower switch of a half: closed, open, or undefined.
type Switches = [Option<bool>; 2];

const OPEN: Switches = [Some(false); 2];
const UPPER: Switches = [Some(true), Some(false)];
const LOWER: Switches = [Some(false), Some(true)];
const BOTH: Switches = [Some(true); 2];

/// Time without switching around the middle of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quiet {
    pub(super) before: Time,
    pub(super) after: Time,
}

impl Quiet {
    /// Time without switching that both have in common.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            before: self.before.min(other.before),
            after: self.after.min(other.after),
        }
    }
}

/// TIM1's registers.
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

fn word(mcu: &Stm32f405, address: u32) -> u32 {
    mcu.peek(address).unwrap_or_default()
}

impl<'a> Timer<'a> {
    fn new(mcu: &'a Stm32f405) -> Self {
        Self {
            mcu,
            cr1: word(mcu, CR1),
            cr2: word(mcu, CR2),
            ccmr: word(mcu, CCMR1),
            ccer: word(mcu, CCER),
            bdtr: word(mcu, BDTR),
            top: word(mcu, ARR),
            compare: [word(mcu, CCR1), word(mcu, CCR1 + 4)],
        }
    }

    /// Levels of a channel's two outputs; `None` where it drives none. The
    /// reference is `None` in the dead time.
    fn outputs(&self, channel: usize, reference: Option<bool>) -> [Option<bool>; 2] {
        let nibble = self.ccer >> (4 * channel);
        let is_on = [nibble & 1 != 0, nibble & 4 != 0];
        let inactive = [nibble & 2 != 0, nibble & 8 != 0];
        if is_on == [false; 2] {
            return [None; 2];
        }
        if self.bdtr & MOE == 0 {
            if self.bdtr & OSSI == 0 {
                return [None; 2];
            }
            let idle = [8, 9].map(|bit| self.cr2 >> (bit + 2 * channel) & 1 != 0);
            let closes_both = idle[0] != inactive[0] && idle[1] != inactive[1];
            return (if closes_both { inactive } else { idle }).map(Some);
        }
        if is_on == [true; 2] {
            let active = reference.map_or([false; 2], |reference| [reference, !reference]);
            return [0, 1].map(|output| Some(active[output] != inactive[output]));
        }
        [0, 1].map(|output| {
            if is_on[output] {
                Some(reference.unwrap_or_default() != inactive[output])
            } else {
                (self.bdtr & OSSR != 0).then_some(inactive[output])
            }
        })
    }

    /// Levels at the gates of a half.
    fn switches(&self, channel: usize, reference: Option<bool>) -> Switches {
        let outputs = self.outputs(channel, reference);
        let pins = [HALF_A, HALF_B][channel];
        [0, 1].map(|output| self.level(pins[output], outputs[output]))
    }

    fn level(&self, pin: Pin, driven: Option<bool>) -> Option<bool> {
        let setup = self.mcu.pin_setup(pin);
        let driven = match setup.mode {
            mode if mode == Mode::of(&drive::UPPER_A) => driven,
            Mode::Output => Some(self.mcu.pin(pin)),
            _ => None,
        };
        match (driven, setup.pull) {
            (Some(true), _) if setup.is_open_drain => None,
            (Some(level), _) => Some(level),
            (None, Pull::Up) => Some(true),
            (None, Pull::Down) => Some(false),
            (None, Pull::None) => None,
        }
    }

    fn dead_clocks(&self) -> u32 {
        let set = self.bdtr & 0xff;
        let clocks = match set >> 5 {
            0..4 => set,
            4 | 5 => 2 * (64 + (set & 63)),
            6 => 8 * (32 + (set & 31)),
            _ => 16 * (32 + (set & 31)),
        };
        clocks << (self.cr1 >> 8 & 3)
    }

    /// The states of a half in a period, and the counts of it for which the
    /// upper switch is closed.
    fn half(&self, channel: usize) -> (Vec<Switches>, Option<u32>) {
        let compare = self.compare[channel].min(self.top);
        let [active, inactive] = [true, false].map(|it| self.switches(channel, Some(it)));
        let mut states = Vec::new();
        if compare > 0 {
            states.push(active);
        }
        if compare < self.top {
            states.push(inactive);
        }
        if self.dead_clocks() > 0 {
            states.push(self.switches(channel, None));
        }
        let closed = match (active, inactive) {
            (UPPER, LOWER) => Some(compare),
            (LOWER, UPPER) => Some(self.top - compare),
            _ => None,
        };
        (states, closed)
    }

    fn terminals(&self, supply_v: f64) -> Terminals {
        let is_pwm = self.cr1 & CEN != 0 && self.mode_problem().is_none();
        let [a, b] = [0, 1].map(|channel| self.half(channel).1);
        let (true, Some(a), Some(b)) = (is_pwm, a, b) else {
            return Terminals::Open;
        };
        let share = (f64::from(a) - f64::from(b)) / f64::from(self.top.max(1));
        Terminals::Driven(share * supply_v)
    }

    /// Problem with the mode of the timer or of a channel.
    fn mode_problem(&self) -> Option<&'static str> {
        if self.cr1 & CMS == 0 {
            Some("not centre-aligned")
        } else if self.cr1 & ARPE == 0 {
            Some("its period has no preload")
        } else if self.ccmr & 0xff != PWM_1_WITH_PRELOAD {
            Some("channel 1 is not in PWM mode 1 with preload")
        } else if self.ccmr >> 8 & 0xff != PWM_1_WITH_PRELOAD {
            Some("channel 2 is not in PWM mode 1 with preload")
        } else {
            None
        }
    }
}

/// The motor's terminals.
pub(super) fn terminals(mcu: &Stm32f405, supply_v: f64) -> Terminals {
    Timer::new(mcu).terminals(supply_v)
}

/// Everything about the switches that the power board does not stand.
pub(super) fn check(mcu: &Stm32f405, mut report: impl FnMut(BoardError)) {
    let timer = Timer::new(mcu);
    for (channel, half) in ['A', 'B'].into_iter().enumerate() {
        let (states, _) = timer.half(channel);
        if states.contains(&BOTH) {
            report(BoardError::ShootThrough { half });
        }
        if states.iter().flatten().any(Option::is_none) {
            report(BoardError::UndefinedSwitch { half });
        }
        let is_float = timer.bdtr & MOE == 0;
        if is_float && states.iter().any(|state| *state != OPEN && *state != BOTH) {
            report(BoardError::ClosedAtRest { half });
        }
    }
    if let Some(what) = timer.mode_problem() {
        report(BoardError::Pwm { what });
    }
    let dead_ns = u64::from(timer.dead_clocks()) * UNITS * 1_000 / 336;
    if !DEAD_NS.contains(&dead_ns) {
        report(BoardError::DeadTime { ns: dead_ns });
    }
}

/// Time without switching before and after the top of TIM1. Before it, the last edge
/// is late by the dead time.
pub(super) fn quiet(mcu: &Stm32f405) -> Quiet {
    let timer = Timer::new(mcu);
    let [a, b] = timer.compare.map(|compare| compare.min(timer.top));
    let after = timer.top - a.max(b);
    let before = after.saturating_sub(timer.dead_clocks());
    let [before, after] = [before, after].map(|clocks| Time::from_units(u64::from(clocks) * UNITS));
    Quiet { before, after }
}

/// Time since TIM1 was at its bottom, if it runs.
pub(super) fn phase(mcu: &Stm32f405) -> Option<Time> {
    phase_of(mcu, CR1)
}

/// Time since the advanced timer at this address was at its bottom, if it runs.
pub(super) fn phase_of(mcu: &Stm32f405, base: u32) -> Option<Time> {
    let control = word(mcu, base);
    if control & CEN == 0 {
        return None;
    }
    let (top, count) = (
        u64::from(word(mcu, base + (ARR - CR1))),
        u64::from(word(mcu, base + (CNT - CR1))),
    );
    let clocks = if control & DIR == 0 {
        count
    } else {
        (2 * top).saturating_sub(count)
    };
    Some(Time::from_units(clocks * UNITS))
}

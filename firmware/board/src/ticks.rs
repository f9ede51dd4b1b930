//! The timers that start tasks, and the one that checks them.
//!
//! ```text
//! TIM1   ╱╲        bridge: up and down in 50 µs; switches load at the bottom
//!       ╱  ╲
//! TIM4  |          sample_encoder, at the bottom, and after it render_torque
//! TIM3     |       the converters, in the middle of the top: no switching near
//!           |      command_motor, 7.4 µs later: the currents are converted, the torque is ready
//! TIM8   as TIM1: the driver of the coil
//! TIM2  ...        µs, for the time between two ticks
//! ```
//!
//! All count the same crystal and are never stopped: ticks continue whatever the
//! bridge does. The first four start together: TIM1's enable is the trigger (ITR0) of the others.

use crate::bridge::Bridge;
use crate::clocks::APB1_TIMER_HZ;
use crate::coil::Coil;
use crate::converter;
use stm32f4xx_hal::pac::{TIM2, TIM3, TIM4};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Counts of TIM3 and TIM4 in a tick.
const COUNTS: u16 = 4_200;
const _: () = assert!(COUNTS as u32 * 20_000 == APB1_TIMER_HZ);

/// Clocks of the core in a count.
const COUNT_CLOCKS: u16 = 2;

/// The samples of a current are centred on the middle of the tick: the converters
/// begin 1.14 µs before it.
const CONVERTER_EARLY: u16 = converter::TO_MIDDLE / COUNT_CLOCKS;

/// Counts from the converters' start to `command_motor`: 7.4 µs. All conversions take 2.86; the
/// rest is time for `render_torque`, whose first tick after a commit of everything takes some 30 µs. What
/// is commanded is loaded at the bottom, 19 µs later, whenever it came.
const CONVERSION: u16 = 620;
const _: () = assert!(CONVERSION * COUNT_CLOCKS > converter::TO_END + 48);

/// Clocks of TIM2 in a microsecond.
const MICROSECOND: u16 = 84;
const _: () = assert!(MICROSECOND as u32 * 1_000_000 == APB1_TIMER_HZ);

/// The middle of a tick.
pub struct MiddleOfTick(TIM3);

/// The beginning of a tick.
pub struct BeginOfTick(TIM4);

impl MiddleOfTick {
    /// A timer that waits for [`start`].
    pub fn new(timer: TIM3, rcc: &mut Rcc) -> Self {
        TIM3::enable(rcc);
        TIM3::reset(rcc);
        timer.arr().write(|w| w.arr().set(COUNTS - 1));
        timer
            .cnt()
            .write(|w| w.cnt().set(COUNTS / 2 + CONVERTER_EARLY));
        timer.ccr1().write(|w| w.ccr().set(CONVERSION));
        // The timer's overflow starts the converters, its first channel the task.
        timer.cr2().write(|w| w.mms().update());
        timer.smcr().write(|w| w.ts().itr0().sms().trigger_mode());
        timer.dier().write(|w| w.cc1ie().set_bit());
        Self(timer)
    }

    /// The task has begun.
    pub fn acknowledge(&mut self) {
        self.0.sr().write(|w| w.cc1if().clear());
    }
}

impl BeginOfTick {
    /// Clocks of the core since the tick has begun.
    pub fn clocks(&self) -> u32 {
        u32::from(self.0.cnt().read().cnt().bits()) * u32::from(COUNT_CLOCKS)
    }

    /// A timer that waits for [`start`].
    pub fn new(timer: TIM4, rcc: &mut Rcc) -> Self {
        TIM4::enable(rcc);
        TIM4::reset(rcc);
        timer.arr().write(|w| w.arr().set(COUNTS - 1));
        timer.dier().write(|w| w.uie().set_bit());
        timer.smcr().write(|w| w.ts().itr0().sms().trigger_mode());
        Self(timer)
    }

    /// The task has begun.
    pub fn acknowledge(&mut self) {
        self.0.sr().write(|w| w.uif().clear());
    }
}

/// Starts the four timers by one store, whatever the core waits for: that of the bridge triggers the
/// others, which follow some clocks later, always as many.
pub fn start(bridge: &Bridge, _: &MiddleOfTick, _: &BeginOfTick, _: &Coil) {
    bridge.timer().cr1().modify(|_, w| w.cen().set_bit());
}

/// A clock that runs by itself: µs, for the drive.
pub struct FreeClock {
    timer: TIM2,
    last_us: u32,
}

impl FreeClock {
    /// Starts it.
    pub fn start(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        timer.psc().write(|w| w.psc().set(MICROSECOND - 1));
        timer.arr().write(|w| w.arr().set(u32::MAX));
        // Loads the prescaler.
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        Self { timer, last_us: 0 }
    }

    /// Time since the last call, µs; wraps.
    pub fn interval_us(&mut self) -> u32 {
        let now_us = self.timer.cnt().read().cnt().bits();
        now_us.wrapping_sub(core::mem::replace(&mut self.last_us, now_us))
    }
}

/// Quarters of a millisecond, for comms.
pub struct Quarters(TIM2);

impl Quarters {
    /// Starts the timer.
    pub fn start(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        timer
            .arr()
            .write(|w| w.arr().set(APB1_TIMER_HZ / 4_000 - 1));
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        Self(timer)
    }

    /// The task has begun.
    pub fn acknowledge(&mut self) {
        self.0.sr().write(|w| w.uif().clear());
    }
}

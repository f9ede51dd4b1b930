//! The driver of the vibration actuator's coil: an H-bridge with two inputs, on TIM8.
//!
//! ```text
//! IN1 IN2     is                        in a tick of 20 kHz, for a duty d > 0
//!  1   0      drives forward            IN1  ▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔
//!  0   1      drives back               IN2  ▁▁▁▁▁▔▔▔▔▔▔▁▁▁▁▁
//!  1   1      brakes: V = 0                  drives   brakes   drives
//!  0   0      asleep: coil open              bottom   middle   bottom
//! ```
//!
//! Sign and magnitude, driving and braking: the coil sees a voltage of either sign from
//! a low resistance, and no ripple at d = 0, where locked anti-phase would have 0.6 A.
//! It never coasts, which these drivers take for a command to sleep. Centre-aligned in
//! step with TIM1, it brakes around the middle of the tick, so that nothing switches
//! while the converters sample; the largest duty leaves them their time.
//!
//! | pin | timer | of the driver |
//! |---|---|---|
//! | PC8, PC9 | CH3, CH4 | IN1, IN2 |
//! | PA6 | BKIN | nFAULT, low; a broken wire is low, too |
//!
//! The driver's nSLEEP is both enable lines, by a gate: no pin. A break turns both inputs low
//! without the program, until the program lets it sleep. Break and idle levels are
//! locked until the next reset. An actuator that is not used costs one test.

use crate::bridge::{QUIET_CLOCKS, TOP};
use crate::pins::resistor;
use crepitus_device::board::pins::drive;
use crepitus_device::board::{LARGEST_COIL_DUTY, Pull};
use crepitus_model::Real;
use stm32f4xx_hal::gpio::alt::tim8::{Bkin, Ch3, Ch4};
use stm32f4xx_hal::gpio::{PinPull, PinSpeed, Speed};
use stm32f4xx_hal::pac::TIM8;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Counts without switching on either side of the middle, at the largest duty: no fewer
/// than the motor's bridge leaves.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "within 0 and TOP"
)]
const BRAKES: u16 = ((1.0 - LARGEST_COIL_DUTY) * TOP as f32 + 0.5) as u16;
const _: () = assert!(BRAKES >= QUIET_CLOCKS.1);

/// The driver.
pub struct Coil {
    timer: TIM8,
    is_driven: bool,
}

impl Coil {
    /// A driver that sleeps; the timer waits for [that of the bridge](crate::ticks::start).
    pub fn new(
        timer: TIM8,
        inputs: (impl Into<Ch3>, impl Into<Ch4>),
        fault: impl Into<Bkin>,
        rcc: &mut Rcc,
    ) -> Self {
        TIM8::enable(rcc);
        TIM8::reset(rcc);
        timer.smcr().write(|w| w.ts().itr0().sms().trigger_mode());
        timer
            .cr1()
            .write(|w| w.cms().center_aligned1().arpe().set_bit());
        timer.arr().write(|w| w.arr().set(TOP));
        // High from the compare value up: at 0 always.
        timer.ccmr2_output().write(|w| {
            w.oc3m().pwm_mode2().oc3pe().set_bit();
            w.oc4m().pwm_mode2().oc4pe().set_bit()
        });
        timer.ccer().write(|w| w.cc3e().set_bit().cc4e().set_bit());
        timer.bdtr().write(|w| {
            w.ossi().idle_level().ossr().idle_level();
            w.bkp().active_low().bke().enabled();
            w.aoe().manual().moe().disabled_idle();
            w.lock().level2()
        });
        timer.egr().write(|w| w.ug().set_bit());
        let mut fault: Bkin = fault.into();
        fault.set_internal_resistor(resistor(drive::COIL_FAULT.pull));
        input::<Ch3>(inputs.0.into(), drive::COIL_IN1.pull);
        input::<Ch4>(inputs.1.into(), drive::COIL_IN2.pull);
        Self {
            timer,
            is_driven: false,
        }
    }

    /// Returns whether it was driven since the last tick: then there is a current to be read.
    pub fn is_driven(&self) -> bool {
        self.is_driven
    }

    /// Returns whether the break has fired since it was asleep.
    pub fn has_tripped(&self) -> bool {
        self.is_driven && self.timer.sr().read().bif().bit()
    }

    /// Applies a share of its supply's voltage, −1 to 1, from the next period on. NaN or
    /// an infinity lets it sleep.
    pub fn drive(&mut self, duty: f32) {
        if !duty.is_finite() {
            self.sleep();
            return;
        }
        self.set_duty(duty);
        if !self.is_driven {
            self.is_driven = true;
            // What was before it was awake is none of its faults; a break that is there has
            // the flag again, and the outputs stay off.
            self.timer.sr().write(|w| w.bif().clear());
            self.timer.bdtr().modify(|_, w| w.moe().set_bit());
        }
    }

    /// Turns both inputs low at once.
    pub fn sleep(&mut self) {
        if self.is_driven {
            self.timer.bdtr().modify(|_, w| w.moe().clear_bit());
            self.is_driven = false;
            self.set_duty(0.0);
        }
    }

    fn set_duty(&mut self, duty: f32) {
        let drives = counts(duty.abs().at_most(LARGEST_COIL_DUTY) * f32::from(TOP));
        let (forward, back) = if duty > 0.0 { (0, drives) } else { (drives, 0) };
        self.timer.ccr3().write(|w| w.ccr().set(forward));
        self.timer.ccr4().write(|w| w.ccr().set(back));
    }
}

/// An input of the driver: low where nothing drives it.
fn input<P: PinPull + PinSpeed>(mut pin: P, pull: Pull) {
    pin.set_speed(Speed::Medium);
    pin.set_internal_resistor(resistor(pull));
}

fn counts(share: f32) -> u16 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast from float saturates; within 0 and TOP anyway"
    )]
    // To 32 bits it is one instruction.
    let counts = (share + 0.5) as u32;
    u16::try_from(counts).unwrap_or(0)
}

//! The bridge: four switches on TIM1, with dead time and a break input.
//!
//! Unipolar and centre-aligned: both halves switch at 20 kHz, one with the
//! share ½ + v/2 of the period and the other with ½ − v/2, so the motor sees
//! 40 kHz and a ripple of 0.55 A. In the middle of the tick both lower
//! switches are closed: nothing switches near the converter.
//!
//! | pin | timer | switch |
//! |---|---|---|
//! | PA8, PB13 | CH1, CH1N | upper and lower of half A |
//! | PA9, PB14 | CH2, CH2N | upper and lower of half B |
//! | PB12 | BKIN | low: overcurrent, or the driver's fault; a broken wire is low, too |
//!
//! Off is all four low: the motor coasts. The break does that in hardware,
//! and persists until the program floats the bridge, too. Dead time, break
//! and idle levels are locked until the next reset.

use crate::clocks::APB2_TIMER_HZ;
use crate::pins::resistor;
use crepitus_device::board::pins::drive;
use crepitus_device::board::{DEAD_CLOCKS, LARGEST_DUTY, PWM_HZ, Pull};
use crepitus_model::Real;
use stm32f4xx_hal::gpio::alt::tim1::{Bkin, Ch1, Ch1N, Ch2, Ch2N};
use stm32f4xx_hal::gpio::{PinPull, PinSpeed, Speed};
use stm32f4xx_hal::pac::TIM1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Counts from bottom to top.
pub(crate) const TOP: u16 = 4_200;
const _: () = assert!(2 * TOP as u32 * PWM_HZ == APB2_TIMER_HZ);

/// Clocks without switching before and after the middle of a tick, at the largest
/// duty. Before it, the last edge is late by the dead time.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "within 0 and TOP"
)]
pub(crate) const QUIET_CLOCKS: (u16, u16) = {
    let after = ((1.0 - LARGEST_DUTY) * (TOP / 2) as f32) as u16;
    (after - DEAD_CLOCKS as u16, after)
};

/// The bridge.
pub struct Bridge {
    timer: TIM1,
    is_driven: bool,
}

impl Bridge {
    /// A floating bridge; the timer is not started.
    pub fn new(
        timer: TIM1,
        half_a: (impl Into<Ch1>, impl Into<Ch1N>),
        half_b: (impl Into<Ch2>, impl Into<Ch2N>),
        breaks: impl Into<Bkin>,
        rcc: &mut Rcc,
    ) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        // Its enable starts the other timers.
        timer.cr2().write(|w| w.mms().enable());
        timer
            .cr1()
            .write(|w| w.cms().center_aligned1().arpe().set_bit());
        timer.arr().write(|w| w.arr().set(TOP));
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1().oc1pe().set_bit();
            w.oc2m().pwm_mode1().oc2pe().set_bit()
        });
        timer.ccer().write(|w| {
            w.cc1e().set_bit().cc1ne().set_bit();
            w.cc2e().set_bit().cc2ne().set_bit()
        });
        // Idle levels are low after a reset. The HAL's driver would re-enable
        // the outputs automatically after a break; here only the program does.
        timer.bdtr().write(|w| {
            w.dtg().set(DEAD_CLOCKS);
            w.ossi().idle_level().ossr().idle_level();
            w.bkp().active_low().bke().enabled();
            w.aoe().manual().moe().disabled_idle();
            w.lock().level2()
        });
        let mut bridge = Self {
            timer,
            is_driven: false,
        };
        bridge.set_duty(0.0);
        bridge.timer.egr().write(|w| w.ug().set_bit());
        let mut breaks: Bkin = breaks.into();
        breaks.set_internal_resistor(resistor(drive::BREAK.pull));
        output::<Ch1>(half_a.0.into(), drive::UPPER_A.pull);
        output::<Ch1N>(half_a.1.into(), drive::LOWER_A.pull);
        output::<Ch2>(half_b.0.into(), drive::UPPER_B.pull);
        output::<Ch2N>(half_b.1.into(), drive::LOWER_B.pull);
        bridge.float();
        bridge
    }

    /// The timer, which [`start`](crate::ticks::start) starts.
    pub(crate) fn timer(&self) -> &TIM1 {
        &self.timer
    }

    /// Applies a share of the supply's voltage, −1 to 1, from the next period on.
    /// NaN or an infinity floats the bridge.
    pub fn drive(&mut self, duty: f32) {
        if !duty.is_finite() {
            self.float();
            return;
        }
        self.set_duty(duty);
        if !self.is_driven {
            self.is_driven = true;
            // Has no effect while the break is there.
            self.timer.bdtr().modify(|_, w| w.moe().set_bit());
        }
    }

    /// Opens all switches at once, and clears a break that is over.
    pub fn float(&mut self) {
        self.timer.bdtr().modify(|_, w| w.moe().clear_bit());
        self.is_driven = false;
        self.set_duty(0.0);
        self.timer.sr().write(|w| w.bif().clear());
    }

    /// Returns whether the break has fired since the bridge floated last.
    pub fn break_has_fired(&self) -> bool {
        self.timer.sr().read().bif().bit()
    }

    fn set_duty(&mut self, duty: f32) {
        let half = f32::from(TOP / 2);
        let swing = duty.within(1.0) * half;
        self.timer
            .ccr1()
            .write(|w| w.ccr().set(counts(half + swing)));
        self.timer
            .ccr2()
            .write(|w| w.ccr().set(counts(half - swing)));
    }
}

/// A pin of the bridge: low where nothing drives it, and with edges that are
/// short beside the dead time.
fn output<P: PinPull + PinSpeed>(mut pin: P, pull: Pull) {
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
    let counts = share as u32;
    u16::try_from(counts).unwrap_or(TOP)
}

//! The motor's current, converted once a tick in step with the bridge.
//!
//! PC0 measures an amplifier of 20 V/V across a shunt of 33 mΩ in the motor's
//! line (INA240A1). Zero is half of the supply, which is also the converter's
//! reference: 0.66 V/A, ±2.5 A, 1.22 mA a count, which is 4 mN·m at the joint.
//! The amplifier's offset is measured at every arming.

use crate::raw;
use stm32f4xx_hal::gpio::PC0;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// PC0.
const CHANNEL: u8 = 10;

/// Supply and reference, V.
const REFERENCE_V: f32 = 3.3;

/// Gain of shunt and amplifier, V/A.
const VOLTS_PER_AMPERE: f32 = 20.0 * 0.033;

/// Counts of the whole range.
const COUNTS: f32 = 4096.0;

/// The converter.
pub struct Converter(ADC1);

impl Converter {
    /// A converter triggered by TIM3.
    pub fn new(converter: ADC1, common: &ADC_COMMON, pin: PC0, rcc: &mut Rcc) -> Self {
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        pin.into_analog();
        // 84 MHz / 4 = 21 MHz; 15 clocks to sample, 12 to convert.
        common.ccr().write(|w| w.adcpre().div4());
        converter.smpr1().write(|w| w.smp10().cycles15());
        raw::converter_channel(&converter, CHANNEL);
        converter.cr2().write(|w| {
            w.extsel().tim3trgo().exten().rising_edge();
            w.adon().set_bit()
        });
        Self(converter)
    }

    /// Takes the current, A, positive towards growing angle; `None` without a
    /// new conversion.
    pub fn take_a(&mut self) -> Option<f32> {
        if !self.0.sr().read().eoc().bit() {
            return None;
        }
        // Reading clears the flag.
        let counts = f32::from(self.0.dr().read().data().bits());
        Some((counts - COUNTS / 2.0) * (REFERENCE_V / COUNTS / VOLTS_PER_AMPERE))
    }
}

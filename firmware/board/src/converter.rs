//! The motor's current, converted once a tick in step with the bridge: twice, on
//! two ways that share nothing but the supply.
//!
//! | way | shunt | pin | converter | for |
//! |---|---|---|---|---|
//! | sensor | between half A and the motor | PC0 | ADC1 | the current loop |
//! | monitor | between half B and the motor | PC1 | ADC2 | checks; the comparator sees its amplifier, too |
//!
//! Each has an amplifier of 20 V/V across 33 mΩ (INA240A1). Zero is half of the
//! supply, which is also the converters' reference: 0.66 V/A, ±2.5 A, 1.22 mA a
//! count, which is 4 mN·m at the joint. The offsets are measured at every arming.
//!
//! The monitor's amplifier is wired the other way round: a shift of the
//! reference that moved both alike would make the two differ.

use crate::raw;
use stm32f4xx_hal::gpio::{PC0, PC1};
use stm32f4xx_hal::pac::adc1::RegisterBlock as Registers;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC2};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// PC0.
const SENSOR: u8 = 10;

/// PC1.
const MONITOR: u8 = 11;

/// Supply and reference, V.
const REFERENCE_V: f32 = 3.3;

/// Gain of shunt and amplifier, V/A.
const VOLTS_PER_AMPERE: f32 = 20.0 * 0.033;

/// Counts of the whole range.
const COUNTS: f32 = 4096.0;

/// The two converters.
pub struct Converters {
    sensor: ADC1,
    monitor: ADC2,
}

impl Converters {
    /// Converters that TIM3 triggers together.
    pub fn new(
        (sensor, monitor): (ADC1, ADC2),
        common: &ADC_COMMON,
        pins: (PC0, PC1),
        rcc: &mut Rcc,
    ) -> Self {
        ADC1::enable(rcc);
        ADC2::enable(rcc);
        // One reset for all three.
        ADC1::reset(rcc);
        pins.0.into_analog();
        pins.1.into_analog();
        // 84 MHz / 4 = 21 MHz; 15 clocks to sample, 12 to convert.
        common.ccr().write(|w| w.adcpre().div4());
        sensor.smpr1().write(|w| w.smp10().cycles15());
        monitor.smpr1().write(|w| w.smp11().cycles15());
        raw::converter_channel(&sensor, SENSOR);
        raw::converter_channel(&monitor, MONITOR);
        for converter in [&*sensor, &*monitor] {
            converter.cr2().write(|w| {
                w.extsel().tim3trgo().exten().rising_edge();
                w.adon().set_bit()
            });
        }
        Self { sensor, monitor }
    }

    /// Takes the sensor's current, A, positive towards growing angle; `None`
    /// without a new conversion.
    pub fn take_sensor_a(&mut self) -> Option<f32> {
        take(&self.sensor)
    }

    /// Takes the monitor's current, A.
    pub fn take_monitor_a(&mut self) -> Option<f32> {
        take(&self.monitor).map(|a| -a)
    }
}

fn take(converter: &Registers) -> Option<f32> {
    if !converter.sr().read().eoc().bit() {
        return None;
    }
    // Reading clears the flag.
    let counts = f32::from(converter.dr().read().data().bits());
    Some((counts - COUNTS / 2.0) * (REFERENCE_V / COUNTS / VOLTS_PER_AMPERE))
}

//! Analog inputs, converted in every tick in step with the bridge: the motor's current
//! twice, on two ways that share nothing but the supply, and what changes slowly in
//! turn.
//!
//! | way | of | pin | converter | for |
//! |---|---|---|---|---|
//! | sensor | a shunt between half A and the motor | PC0 | ADC1 | the current loop, checks |
//! | monitor | a shunt between half B and the motor | PC1 | ADC2 | the current loop, checks; the comparator sees its amplifier, too |
//! | supply | a divider by 16 | PC3 | ADC3 | checks |
//! | temperature | MCP9700 on the motor: 0.5 V and 10 mV/°C | PA2 | ADC3 | checks |
//! | joint | AS5600 on the hinge: its turn is the reference | PC2 | ADC3 | checks |
//! | coil | a shunt at the coil of the vibration actuator | PA3 | ADC3, injected | checks, telemetry |
//!
//! Each current has an amplifier of 20 V/V across 33 mΩ (INA240A1). Zero is half of the
//! supply, which is also the converters' reference: 0.66 V/A, ±2.5 A, 1.22 mA a
//! count, which is 4 mN·m at the joint. The offsets are measured at every arming.
//!
//! The monitor's amplifier is wired the other way round: a shift of the
//! reference that moved both alike would make the two differ.
//!
//! The loop takes the one whose half switched earlier
//! ([`current_path`](crepitus_model::control::current_path)).
//!
//! A current is the mean of four conversions in a row, which halves the converter's
//! noise: a regular one, which the timer starts, and the three of the injected group
//! (JAUTO), whose results have registers of their own.
//!
//! ```text
//!             1.14 µs          middle of the tick             1.71 µs
//! trigger ──> ▓▓──────────── ▓▓──────────── ▓▓──────────── ▓▓──────────── JEOC
//!             3 clocks of sampling, 12 of conversion
//! ```
//!
//! The coil's current follows the slow input of the tick by itself (JAUTO), its sampling
//! 0.5 µs after the middle, where its driver brakes. Its amplifier has 20 V/V across
//! 25 mΩ: 0.5 V/A, ±3.3 A, 1.6 mA a count; positive is the sign of its command.
//!
//! Three clocks are enough, as a converter has one channel only: its capacitor still
//! holds the current of the last conversion. Decision 97 in docs/decisions.md has the
//! figures.

use crate::bridge::QUIET_CLOCKS;
use crate::clocks::APB2_TIMER_HZ;
use crate::raw;
use crepitus_device::board::analog::{self, CLOCK_HZ, INPUTS};
use crepitus_device::board::{self, COIL_CURRENT, MOTOR_CURRENT, MOTOR_TEMPERATURE};
use crepitus_device::drive::slow_checks::SlowInput;
use stm32f4xx_hal::gpio::{Analog, ErasedPin};
use stm32f4xx_hal::pac::adc1::RegisterBlock as Registers;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC2, ADC3};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Channels of the inputs.
const SENSOR: u8 = analog::SENSOR.channel;
const MONITOR: u8 = analog::MONITOR.channel;
const SUPPLY: u8 = analog::SUPPLY.channel;
const MOTOR: u8 = analog::MOTOR.channel;
const JOINT: u8 = analog::JOINT.channel;
const COIL: u8 = analog::COIL.channel;

/// Divider of the supply.
const SUPPLY_SHARE: f32 = single(board::SUPPLY.share());

/// Temperature sensor of the motor: V at 0 °C, and °C for a volt.
const FREEZING_V: f32 = single(MOTOR_TEMPERATURE.freezing_v);
const CELSIUS_PER_VOLT: f32 = single(MOTOR_TEMPERATURE.celsius_per_volt);

/// Supply and reference, V.
const REFERENCE_V: f32 = single(board::REFERENCE_V);

/// Gain of shunt and amplifier, V/A.
const VOLTS_PER_AMPERE: f32 = MOTOR_CURRENT.volts_per_ampere_single();

/// Gain of the coil's shunt and amplifier, V/A.
const COIL_VOLTS_PER_AMPERE: f32 = COIL_CURRENT.volts_per_ampere_single();

#[expect(
    clippy::cast_possible_truncation,
    reason = "values of parts, for the controller's arithmetic"
)]
const fn single(value: f64) -> f32 {
    value as f32
}

/// Counts of the whole range.
const COUNTS: f32 = 4096.0;

/// Conversions of a current in a tick.
pub(crate) const SAMPLES: u8 = 4;

/// Clocks of the core in one of the converters: 168 MHz / 21 MHz.
const CONVERTER_CLOCK: u16 = 8;
const _: () = assert!(CONVERTER_CLOCK as u32 * CLOCK_HZ == APB2_TIMER_HZ);

/// Clocks of the core to sample a current, and to sample and convert it.
const SAMPLING: u16 = analog::SENSOR.sampling_clocks * CONVERTER_CLOCK;
const CONVERSION: u16 = SAMPLING + 12 * CONVERTER_CLOCK;

/// Time from the first sampling to the end of the last conversion, and to the middle of all
/// samplings, in clocks of the core.
pub(crate) const TO_END: u16 = SAMPLES as u16 * CONVERSION;
pub(crate) const TO_MIDDLE: u16 = u16::midpoint(0, TO_END - CONVERSION + SAMPLING);

/// The slow input and the coil's current.
const SLOW_TO_END: u16 =
    (analog::SUPPLY.sampling_clocks + analog::COIL.sampling_clocks + 2 * 12) * CONVERTER_CLOCK;

/// The most that the trigger is late: three clocks of the converters, and that of the timer, which takes
/// up the trigger of another in some clocks of APB1.
const LATE: u16 = 3 * CONVERTER_CLOCK + 16;

// Nothing switches while they convert.
const _: () = assert!(TO_MIDDLE <= QUIET_CLOCKS.0);
const _: () = assert!(TO_END - TO_MIDDLE + LATE <= QUIET_CLOCKS.1);
const _: () = assert!(SLOW_TO_END <= TO_END);

/// The converters.
pub struct Converters {
    sensor: ADC1,
    monitor: ADC2,
    slow: ADC3,
    /// Channel that the third one converts next.
    channel: u8,
}

impl Converters {
    /// Converters that TIM3 triggers together, with the pins of their [inputs](INPUTS).
    pub fn new(
        (sensor, monitor, slow): (ADC1, ADC2, ADC3),
        common: &ADC_COMMON,
        _: [ErasedPin<Analog>; INPUTS.len()],
        rcc: &mut Rcc,
    ) -> Self {
        ADC1::enable(rcc);
        ADC2::enable(rcc);
        ADC3::enable(rcc);
        // One reset for all three.
        ADC1::reset(rcc);
        // 84 MHz / 4 = 21 MHz.
        common.ccr().write(|w| w.adcpre().div4());
        for input in INPUTS {
            let converter = match input.converter {
                1 => &*sensor,
                2 => &*monitor,
                _ => &*slow,
            };
            raw::converter_sampling(converter, input.channel, input.sampling_code());
        }
        raw::converter_channel(&slow, SUPPLY);
        raw::converter_channel(&sensor, SENSOR);
        raw::converter_channel(&monitor, MONITOR);
        for (converter, channel, conversions) in [
            (&*sensor, SENSOR, SAMPLES - 1),
            (&*monitor, MONITOR, SAMPLES - 1),
            (&*slow, COIL, 1),
        ] {
            raw::injected_channel(converter, channel, conversions);
            converter
                .cr1()
                .write(|w| w.scan().set_bit().jauto().set_bit());
        }
        for converter in [&*sensor, &*monitor, &*slow] {
            converter.cr2().write(|w| {
                w.extsel().tim3trgo().exten().rising_edge();
                w.adon().set_bit()
            });
        }
        Self {
            sensor,
            monitor,
            slow,
            channel: SUPPLY,
        }
    }

    /// Takes one of the inputs that change slowly, and turns to the next one.
    pub fn take_slow(&mut self) -> SlowInput {
        let Some(share) = take_share(&self.slow) else {
            return SlowInput::None;
        };
        let volts = share * REFERENCE_V;
        let (input, next) = match self.channel {
            SUPPLY => (SlowInput::SupplyV(volts * SUPPLY_SHARE), MOTOR),
            MOTOR => {
                let celsius = (volts - FREEZING_V) * CELSIUS_PER_VOLT;
                (SlowInput::MotorC(celsius), JOINT)
            }
            _ => (SlowInput::JointTurns(share), SUPPLY),
        };
        self.channel = next;
        raw::converter_channel(&self.slow, next);
        input
    }

    /// Takes the sensor's current, A, positive towards growing angle; `None`
    /// without new conversions.
    pub fn take_sensor_a(&mut self) -> Option<f32> {
        take_current_a(&self.sensor)
    }

    /// Takes the current of the coil, A; `None` without a new conversion.
    pub fn take_coil_a(&mut self) -> Option<f32> {
        if !self.slow.sr().read().jeoc().bit() {
            return None;
        }
        self.slow.sr().write(|w| w.jeoc().clear());
        let share = f32::from(self.slow.jdr1().read().jdata().bits()) * (1.0 / COUNTS);
        Some((share - 0.5) * (REFERENCE_V / COIL_VOLTS_PER_AMPERE))
    }

    /// Takes the monitor's current, A.
    pub fn take_monitor_a(&mut self) -> Option<f32> {
        take_current_a(&self.monitor).map(|a| -a)
    }
}

/// Takes the mean of a tick's conversions of a current, A.
fn take_current_a(converter: &Registers) -> Option<f32> {
    if !converter.sr().read().jeoc().bit() {
        return None;
    }
    converter.sr().write(|w| w.jeoc().clear());
    let sum = converter.dr().read().data().bits()
        + converter.jdr1().read().jdata().bits()
        + converter.jdr2().read().jdata().bits()
        + converter.jdr3().read().jdata().bits();
    // Exact, and so are equal conversions that of one.
    let share = f32::from(sum) * (1.0 / (COUNTS * f32::from(SAMPLES)));
    Some((share - 0.5) * (REFERENCE_V / VOLTS_PER_AMPERE))
}

/// Takes a new conversion as a share of the reference.
fn take_share(converter: &Registers) -> Option<f32> {
    if !converter.sr().read().eoc().bit() {
        return None;
    }
    // Reading clears the flag.
    Some(f32::from(converter.dr().read().data().bits()) * (1.0 / COUNTS))
}

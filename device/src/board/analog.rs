//! Analog inputs: the parts before them, and how long they have to be sampled.
//!
//! ```text
//! source ──[R]──┬── pin ──[R_ADC, 6 kΩ]── switch ──┬── C_ADC, 7 pF
//!              [C]                                 ┴
//! ```
//!
//! The data sheet's formula for the largest source resistance has no capacitor at the pin: with three
//! clocks at 21 MHz it allows none, and with 15 only some kΩ. Here C, from 140 times C_ADC on, gives the charge:
//!
//! ```text
//! error / step = C_ADC/(C_ADC + C)·e^(−t/RC)  +  e^(−t/(R_ADC·C_ADC))
//! ```
//!
//! where the step is that from the voltage that the converter held before: of another pin, or of
//! an input that has a converter for itself what it was at the last conversion.

use super::pins::{Connection, Mode, Pin, drive};

/// Resistance of a converter's switch, Ω, at most (STM32F405 data sheet, ADC characteristics).
pub const SWITCH_OHM: f64 = 6e3;

/// Capacitor of a converter, F, at most (there).
pub const HOLD_FARAD: f64 = 7e-12;

/// Clock of the converters, Hz: 84 MHz / 4.
pub const CLOCK_HZ: u32 = 21_000_000;

/// A shunt with its amplifier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplifier {
    /// Shunt, Ω.
    pub shunt_ohm: f64,
    /// Gain, V/V.
    pub gain: f64,
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "values of parts, for the controller's arithmetic"
)]
impl Amplifier {
    /// Scale, V/A.
    pub const fn volts_per_ampere(&self) -> f64 {
        self.gain * self.shunt_ohm
    }

    /// Scale in the controller's arithmetic, V/A.
    pub const fn volts_per_ampere_single(&self) -> f32 {
        self.gain as f32 * self.shunt_ohm as f32
    }

    /// Largest current of either sign: zero is half of the reference, A.
    pub const fn range_a(&self) -> f64 {
        super::REFERENCE_V / 2.0 / self.volts_per_ampere()
    }
}

/// A divider of a voltage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divider {
    /// Resistor from the voltage to the pin, Ω.
    pub upper_ohm: f64,
    /// Resistor from the pin to ground, Ω.
    pub lower_ohm: f64,
}

impl Divider {
    /// Voltage as a multiple of that at the pin.
    pub const fn share(&self) -> f64 {
        (self.upper_ohm + self.lower_ohm) / self.lower_ohm
    }

    /// Resistance of the source, Ω.
    pub const fn source_ohm(&self) -> f64 {
        self.upper_ohm * self.lower_ohm / (self.upper_ohm + self.lower_ohm)
    }
}

/// A temperature sensor with a voltage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureSensor {
    /// Voltage at 0 °C, V.
    pub freezing_v: f64,
    /// Slope, °C/V.
    pub celsius_per_volt: f64,
}

/// The filter of a line that is pulled up at its far end, and low when it is active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Pull-up, Ω.
    pub pull_up_ohm: f64,
    /// Resistor before the pin, Ω.
    pub series_ohm: f64,
    /// Capacitor at the pin, F.
    pub farad: f64,
}

impl Filter {
    /// Time constant of a line that falls, s.
    pub const fn time_constant_s(&self) -> f64 {
        self.series_ohm * self.farad
    }

    /// Level at rest, as a share of the supply, with a pull-down at the pin.
    pub const fn high_share(&self, pull_down_ohm: f64) -> f64 {
        pull_down_ohm / (self.pull_up_ohm + self.series_ohm + pull_down_ohm)
    }
}

/// Sampling times of a converter, clocks, by their code.
pub const SAMPLING_CLOCKS: [u16; 8] = [3, 15, 28, 56, 84, 112, 144, 480];

/// An input of a converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// The pin.
    pub connection: Connection,
    /// The converter, from 1 on.
    pub converter: u8,
    /// The converter's input.
    pub channel: u8,
    /// Clocks of the converter for which it is sampled.
    pub sampling_clocks: u16,
    /// Resistance of the source, Ω.
    pub source_ohm: f64,
    /// Capacitor at the pin, F.
    pub farad: f64,
    /// Step between two conversions of the converter, V.
    pub step_v: f64,
}

impl Input {
    /// Sampling time, s.
    pub fn sampling_s(&self) -> f64 {
        f64::from(self.sampling_clocks) / f64::from(CLOCK_HZ)
    }

    /// Code of the sampling time.
    pub const fn sampling_code(&self) -> u8 {
        match self.sampling_clocks {
            15 => 1,
            28 => 2,
            56 => 3,
            84 => 4,
            112 => 5,
            144 => 6,
            480 => 7,
            _ => 0,
        }
    }
}

/// Step of a current between two conversions of one tick, V: both lower switches are closed, so that
/// it only decays, by 7 A/ms.
const CURRENT_STEP_V: f64 = 0.005;

/// Step between two inputs of the converter that has several, V.
const WHOLE_STEP_V: f64 = super::REFERENCE_V;

/// The channel of a pin, where the converter has it:
///
/// ```
/// use crepitus_device::board::{analog::channel, pins::drive};
/// const SENSOR: u8 = channel(&drive::SENSOR, 1);
/// assert_eq!(SENSOR, 10);
/// ```
///
/// Another pin does not compile:
///
/// ```compile_fail
/// use crepitus_device::board::{analog::channel, pins::drive};
/// const BREAK: u8 = channel(&drive::BREAK, 1);
/// ```
///
/// # Panics
/// In a constant the compiler's error: the converter has no such pin.
#[expect(clippy::panic, reason = "evaluated at compile time only")]
pub const fn channel(connection: &Connection, converter: u8) -> u8 {
    assert!(matches!(connection.mode, Mode::Analog), "not analog");
    let Pin { port, number } = connection.pin;
    // The third one has those of PA0 to PA3 and PC0 to PC3 alone, on 64 pins.
    match (port, number) {
        ('A', 0..4) => number,
        ('C', 0..4) => number.wrapping_add(10),
        ('A', 4..8) if converter < 3 => number,
        ('B', 0..2) if converter < 3 => number.wrapping_add(8),
        ('C', 4..6) if converter < 3 => number.wrapping_add(10),
        _ => panic!("no input of this converter"),
    }
}

const fn current(connection: Connection, converter: u8) -> Input {
    Input {
        connection,
        converter,
        channel: channel(&connection, converter),
        sampling_clocks: 3,
        source_ohm: 100.0,
        farad: 1e-9,
        step_v: CURRENT_STEP_V,
    }
}

const fn slow(connection: Connection, source_ohm: f64, farad: f64) -> Input {
    Input {
        connection,
        converter: 3,
        channel: channel(&connection, 3),
        sampling_clocks: 15,
        source_ohm,
        farad,
        step_v: WHOLE_STEP_V,
    }
}

/// The motor's current, of the loop.
pub const SENSOR: Input = current(drive::SENSOR, 1);

/// The motor's current, of the checks and the comparator.
pub const MONITOR: Input = current(drive::MONITOR, 2);

/// Supply of the bridge.
pub const SUPPLY: Input = slow(drive::SUPPLY, super::SUPPLY.source_ohm(), 100e-9);

/// Temperature of the motor; the sensor's output has some Ω.
pub const MOTOR: Input = slow(drive::MOTOR, 1e3, 100e-9);

/// Angle of the joint.
pub const JOINT: Input = slow(drive::JOINT, 1e3, 100e-9);

/// Current of the coil.
pub const COIL: Input = slow(drive::COIL, 100.0, 1e-9);

/// All analog inputs.
pub const INPUTS: [Input; 6] = [SENSOR, MONITOR, SUPPLY, MOTOR, JOINT, COIL];

#[cfg(test)]
mod tests {
    use super::*;

    /// A count, V.
    const COUNT_V: f64 = crate::board::REFERENCE_V / 4096.0;

    /// Error of a conversion, counts, at most.
    fn error_counts(input: &Input) -> f64 {
        let time_s = input.sampling_s();
        let shared = HOLD_FARAD / (HOLD_FARAD + input.farad);
        let recharged = (-time_s / (input.source_ohm * input.farad)).exp();
        let settled = (-time_s / (SWITCH_OHM * HOLD_FARAD)).exp();
        input.step_v * (shared * recharged + settled) / COUNT_V
    }

    #[test]
    fn each_input_is_sampled_long_enough() {
        for input in INPUTS {
            let counts = error_counts(&input);
            assert!(counts < 0.5, "{}: {counts}", input.connection.part);
        }
    }

    /// Without its capacitor three clocks are too few for a source of any resistance, as the data sheet says.
    #[test]
    fn no_input_would_be_without_its_capacitor() {
        for input in INPUTS {
            let bare = Input {
                farad: 20e-12,
                source_ohm: 9.4e3,
                ..input
            };
            let counts = error_counts(&bare);
            assert!(counts > 0.5, "{}: {counts}", input.connection.part);
        }
    }

    #[test]
    fn sampling_times_have_their_codes() {
        for (code, sampling_clocks) in SAMPLING_CLOCKS.into_iter().enumerate() {
            let input = Input {
                sampling_clocks,
                ..SENSOR
            };
            assert_eq!(usize::from(input.sampling_code()), code);
        }
        assert!(
            INPUTS
                .iter()
                .all(|it| SAMPLING_CLOCKS.contains(&it.sampling_clocks))
        );
    }

    #[test]
    fn functions_name_converter_and_channel() {
        for input in INPUTS {
            let name = std::format!("ADC{} IN{}", input.converter, input.channel);
            assert_eq!(input.connection.function, name);
        }
    }
}

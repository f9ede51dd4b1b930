//! The board description: what is wired to the controllers, and the values of those parts.
//!
//! ```text
//!                ┌─> firmware/board            pins by their types, scales, duty, crystal
//! this file ─────┼─> sim/emulator              wires, sensors, comparator
//!                └─> docs/generated/board.md   the tables for who builds or ports one
//! ```
//!
//! Another board is another version of this file: the [pins] are a list of rows, the
//! parts are below. "Another board in a day" in `docs/hardware.md` has the steps.

pub mod analog;
pub mod pins;

pub use pins::{Connection, Mode, Pin, Pull};

use analog::{Amplifier, Divider, Filter, TemperatureSensor};

/// Crystal of both controllers, Hz: one of [`CRYSTALS_HZ`]. Measured at each start.
pub const CRYSTAL_HZ: u32 = 8_000_000;

/// Crystals from which 168 MHz and 48 MHz follow exactly.
pub const CRYSTALS_HZ: [u32; 4] = [8_000_000, 12_000_000, 16_000_000, 25_000_000];

/// Largest deviation of a measured crystal, as one part in so many: 1/20. The internal oscillator may
/// be off by 4 % from −10 to 85 °C (STM32F405 data sheet, HSI oscillator characteristics, ACC_HSI).
const CRYSTAL_PARTS: u32 = 20;

/// The crystal that was measured, of [`CRYSTALS_HZ`]; `None` if it is near none of them.
pub fn crystal_near(measured_hz: u32) -> Option<u32> {
    let is_near = |hz: &u32| hz.abs_diff(measured_hz) <= hz.div_euclid(CRYSTAL_PARTS);
    CRYSTALS_HZ.into_iter().find(is_near)
}

/// Supply of the amplifiers and reference of the converters, V.
pub const REFERENCE_V: f64 = 3.3;

/// Shunt and amplifier of each of the motor's two currents: INA240A1.
pub const MOTOR_CURRENT: Amplifier = Amplifier {
    shunt_ohm: 0.033,
    gain: 20.0,
};

/// Shunt and amplifier of the vibration actuator's coil: INA240A1.
pub const COIL_CURRENT: Amplifier = Amplifier {
    shunt_ohm: 0.025,
    gain: 20.0,
};

/// Divider of the bridge's supply.
pub const SUPPLY: Divider = Divider {
    upper_ohm: 150e3,
    lower_ohm: 10e3,
};

/// Sensor on the motor's housing: MCP9700.
pub const MOTOR_TEMPERATURE: TemperatureSensor = TemperatureSensor {
    freezing_v: 0.5,
    celsius_per_volt: 100.0,
};

/// Thresholds of the comparator, and of the software, A.
pub const TRIP_A: f32 = 1.95;

/// Filter at each break input: the timers of an F405 have none (RM0090, TIMx_BDTR).
pub const BREAK_FILTER: Filter = Filter {
    pull_up_ohm: 4.7e3,
    series_ohm: 1e3,
    farad: 470e-12,
};

/// Largest duty of the bridge: the lower switches of both halves are closed for 2 µs on either side of
/// the middle, where the currents are converted.
pub const LARGEST_DUTY: f32 = 0.84;

/// Largest duty of the coil's driver: it brakes for 2 µs on either side of the middle.
pub const LARGEST_COIL_DUTY: f32 = 0.92;

/// Frequency of bridge and coil, Hz.
pub const PWM_HZ: u32 = 20_000;

/// Dead time of the bridge, clocks of 168 MHz: 0.3 µs.
pub const DEAD_CLOCKS: u8 = 50;

/// Speed of the link, baud.
pub const LINK_BAUD: u32 = 4_200_000;

/// A timer and what it does on the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimerUse {
    /// Name in the reference manual.
    pub timer: &'static str,
    /// First address of its registers.
    pub base: u32,
    /// Use.
    pub does: &'static str,
    /// Its start.
    pub starts: &'static str,
}

/// Timer of the bridge.
pub const BRIDGE_TIMER: TimerUse = TimerUse {
    timer: "TIM1",
    base: 0x4001_0000,
    does: "switches of the bridge",
    starts: "by the program, last; its enable is the trigger of the next three",
};

/// Timer of the coil's driver.
pub const COIL_TIMER: TimerUse = TimerUse {
    timer: "TIM8",
    base: 0x4001_0400,
    does: "inputs of the coil's driver",
    starts: "by TIM1",
};

/// Timer of the middle of the tick.
pub const MIDDLE_TIMER: TimerUse = TimerUse {
    timer: "TIM3",
    base: 0x4000_0400,
    does: "converters, then `command_motor`",
    starts: "by TIM1",
};

/// Timer of the beginning of the tick.
pub const BEGIN_TIMER: TimerUse = TimerUse {
    timer: "TIM4",
    base: 0x4000_0800,
    does: "`sample_encoder`, then `render_torque`",
    starts: "by TIM1",
};

/// Timer that counts the encoder's edges.
pub const ENCODER_TIMER: TimerUse = TimerUse {
    timer: "TIM5",
    base: 0x4000_0c00,
    does: "count of the encoder, 32 bits",
    starts: "at once",
};

/// Timer that measures the time between two ticks.
pub const CLOCK_TIMER: TimerUse = TimerUse {
    timer: "TIM2",
    base: 0x4000_0000,
    does: "time between two ticks, µs",
    starts: "at once",
};

/// All timers of the drive.
pub const TIMERS: [TimerUse; 6] = [
    BRIDGE_TIMER,
    COIL_TIMER,
    MIDDLE_TIMER,
    BEGIN_TIMER,
    ENCODER_TIMER,
    CLOCK_TIMER,
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::string::ToString;

    #[test]
    fn a_crystal_is_told_from_the_next_one_in_spite_of_the_internal_oscillator() {
        for hz in CRYSTALS_HZ {
            for percent in [96, 98, 100, 102, 104] {
                assert_eq!(crystal_near(hz / 100 * percent), Some(hz));
            }
        }
        for hz in [0, 4_000_000, 10_000_000, 14_000_000, 20_000_000, 27_000_000] {
            assert_eq!(crystal_near(hz), None, "{hz}");
        }
        assert!(CRYSTALS_HZ.contains(&CRYSTAL_HZ));
    }

    #[test]
    fn no_pin_and_no_function_is_wired_twice() {
        for board in [pins::drive::ALL, pins::comms::ALL] {
            let pins: BTreeSet<_> = board.iter().map(|it| it.pin.to_string()).collect();
            assert_eq!(pins.len(), board.len());
            let functions = board.iter().map(|it| it.function);
            let functions: BTreeSet<_> = functions.filter(|name| !name.is_empty()).collect();
            let named = board.iter().filter(|it| !it.function.is_empty()).count();
            assert_eq!(functions.len(), named);
        }
    }

    #[test]
    fn pins_of_the_probe_are_free() {
        for it in pins::drive::ALL.iter().chain(pins::comms::ALL) {
            assert!(!["PA13", "PA14"].contains(&it.pin.to_string().as_str()));
        }
    }

    /// PA9 is USB's VBUS on many boards, and an output of the bridge here: the drive has no USB.
    #[test]
    fn a_board_with_usb_leaves_its_vbus_alone() {
        let has = |board: &[Connection], name| board.iter().any(|it| it.pin.to_string() == name);
        for board in [pins::drive::ALL, pins::comms::ALL] {
            assert!(!(has(board, "PA9") && has(board, "PA11")));
        }
    }

    /// The break opens the switches before the current has grown by a tenth of its limit, and does not
    /// fire for a spike of an edge of the bridge.
    #[test]
    fn the_filter_of_the_break_suits_the_motor() {
        let slope_a_per_s = 24.0 / 0.34e-3;
        // To the lowest level that may count as low, 0.3 of the supply.
        let delay_s = -0.3_f64.ln() * BREAK_FILTER.time_constant_s();
        assert!(delay_s * slope_a_per_s < 0.1 * f64::from(TRIP_A));
        let dead_s = f64::from(DEAD_CLOCKS) / 168e6;
        assert!(delay_s > dead_s, "{delay_s}");
        // High enough with the controller's own pull-down, 30 to 50 kΩ, in spite of the series resistor.
        assert!(BREAK_FILTER.high_share(30e3) > 0.7);
    }

    #[test]
    fn scales_are_those_of_the_parts() {
        assert!((MOTOR_CURRENT.volts_per_ampere() - 0.66).abs() < 1e-12);
        assert!((COIL_CURRENT.volts_per_ampere() - 0.5).abs() < 1e-12);
        assert!((SUPPLY.share() - 16.0).abs() < 1e-12);
        // The comparator is within the amplifier's range.
        assert!(f64::from(TRIP_A) < MOTOR_CURRENT.range_a());
    }
}

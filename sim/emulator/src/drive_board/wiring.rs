//! The wiring of the board, and what does not match it.
//!
//! A peripheral sees and drives only pins that are connected to it. Beyond
//! that the board names every mismatch, from the time on at which the
//! bridge's timer runs: that is the last that the image starts.

use super::board_error::BoardError;
use super::coil_driver;
use super::half_bridges::{self, Quiet};
use super::pin_map::{
    BREAK, COIL, COIL_FAULT, COIL_IN1, COIL_IN2, COMMS_LINE, HALF_A, HALF_B, JOINT, LINE,
    LINE_BACK, MONITOR, MOTOR, SENSOR, SUPPLY,
};
use crate::mcu::Sampling;
use crate::pins::{Mode, Pin, Pull};
use crate::stm32f405::Stm32f405;
use crate::time::Time;

/// The converters, from 1 on, and the pins that they convert around the middle of a
/// tick.
const CONVERTED: [(u32, Pin); 6] = [
    (1, SENSOR),
    (2, MONITOR),
    (3, SUPPLY),
    (3, MOTOR),
    (3, JOINT),
    (3, COIL),
];

/// Converters of the currents.
const CURRENTS: [u32; 2] = [1, 2];

/// The encoder's counter.
const COUNTER: u32 = 0x4000_0c24;

/// Units of time of ten bits at 4.2 Mbaud, and the most that a receiver
/// stands: 2 %.
const CHARACTER_UNITS: u64 = 800;
const MOST_OFF_UNITS: u64 = 16;

/// Time between the middle of a tick and that of all samplings of a current, at most:
/// 0.1 µs.
const MOST_OFF_MIDDLE: Time = Time::from_units(336 / 10);

/// A wire between a pin and a part of the board.
struct Wire {
    pin: Pin,
    /// The part.
    to: &'static str,
    mode: Mode,
    /// `None`: any.
    pull: Option<Pull>,
}

const fn wire(pin: Pin, to: &'static str, mode: Mode, pull: Option<Pull>) -> Wire {
    Wire {
        pin,
        to,
        mode,
        pull,
    }
}

/// All wires, as docs/hardware.md has them.
const WIRES: [Wire; 21] = {
    use Mode::{Alternate, Analog, Input, Output};
    const DOWN: Option<Pull> = Some(Pull::Down);
    const UP: Option<Pull> = Some(Pull::Up);
    [
        wire(
            HALF_A[0],
            "upper switch of half A, TIM1 CH1",
            Alternate(1),
            DOWN,
        ),
        wire(
            HALF_A[1],
            "lower switch of half A, TIM1 CH1N",
            Alternate(1),
            DOWN,
        ),
        wire(
            HALF_B[0],
            "upper switch of half B, TIM1 CH2",
            Alternate(1),
            DOWN,
        ),
        wire(
            HALF_B[1],
            "lower switch of half B, TIM1 CH2N",
            Alternate(1),
            DOWN,
        ),
        wire(BREAK, "break line, TIM1 BKIN", Alternate(1), DOWN),
        wire(SENSOR, "amplifier of the sensor, ADC1 IN10", Analog, None),
        wire(MONITOR, "amplifier of the monitor, ADC2 IN11", Analog, None),
        wire(SUPPLY, "divider of the supply, ADC3 IN13", Analog, None),
        wire(MOTOR, "temperature of the motor, ADC3 IN2", Analog, None),
        wire(JOINT, "sensor of the joint, ADC3 IN12", Analog, None),
        wire(
            COIL_IN1,
            "IN1 of the coil's driver, TIM8 CH3",
            Alternate(3),
            DOWN,
        ),
        wire(
            COIL_IN2,
            "IN2 of the coil's driver, TIM8 CH4",
            Alternate(3),
            DOWN,
        ),
        wire(
            COIL_FAULT,
            "nFAULT of the coil's driver, TIM8 BKIN",
            Alternate(3),
            DOWN,
        ),
        wire(COIL, "amplifier of the coil, ADC3 IN3", Analog, None),
        wire(COMMS_LINE, "enable line of comms", Input, DOWN),
        wire(Pin::new('A', 0), "encoder A, TIM5 CH1", Alternate(2), UP),
        wire(Pin::new('A', 1), "encoder B, TIM5 CH2", Alternate(2), UP),
        wire(LINE, "enable line", Output, None),
        wire(LINE_BACK, "read-back of the enable line", Input, DOWN),
        wire(
            Pin::new('C', 6),
            "link to comms, USART6 TX",
            Alternate(8),
            None,
        ),
        wire(
            Pin::new('C', 7),
            "link from comms, USART6 RX",
            Alternate(8),
            UP,
        ),
    ]
};

/// Reports every pin and every switch that does not match.
pub(super) fn check(mcu: &Stm32f405, mut report: impl FnMut(BoardError)) {
    for wire in &WIRES {
        let is = mcu.pin_setup(wire.pin);
        let is_pulled = wire.pull.is_none_or(|pull| pull == is.pull);
        if is.mode != wire.mode || !is_pulled || is.is_open_drain {
            let pull = wire
                .pull
                .map(|pull| format!(", {pull}"))
                .unwrap_or_default();
            report(BoardError::Pin {
                pin: wire.pin,
                is,
                to: wire.to,
                needs: format!("{}{pull}", wire.mode),
            });
        }
    }
    half_bridges::check(mcu, &mut report);
    coil_driver::check(mcu, half_bridges::phase(mcu), &mut report);
    let units = mcu.link_character_units();
    if units.abs_diff(CHARACTER_UNITS) > MOST_OFF_UNITS {
        report(BoardError::Baud { units });
    }
}

/// Reports samplings of a tick that are of a wrong channel, that are not within `quiet`
/// around its `middle`, conversion included, or, of a current, not centred on it.
pub(super) fn check_samplings(
    samplings: &[Sampling],
    middle: Time,
    quiet: Quiet,
    mut report: impl FnMut(BoardError),
) {
    for sampling in samplings {
        let (converter, channel) = (sampling.converter, sampling.channel);
        let is_wired =
            |(number, pin): &(u32, Pin)| *number == converter && Some(*pin) == sampling.pin;
        if !CONVERTED.iter().any(is_wired) {
            report(BoardError::Channel { converter, channel });
            continue;
        }
        let is_quiet =
            sampling.begin + quiet.before >= middle && sampling.converted <= middle + quiet.after;
        if !is_quiet {
            report(BoardError::SwitchingWhileSampling { converter });
        }
    }
    for converter in CURRENTS {
        let own = samplings.iter().filter(|it| it.converter == converter);
        let (count, sum) = own.fold((0, 0), |(count, sum), sampling| {
            let center = u64::midpoint(sampling.begin.units(), sampling.end.units());
            (count + 1, sum + center)
        });
        // None where a converter is broken: the program's to notice.
        let Some(center) = u64::checked_div(sum, count) else {
            continue;
        };
        let off = center.abs_diff(middle.units());
        if off > MOST_OFF_MIDDLE.units() {
            let off_ns = off * 1_000 / 336;
            report(BoardError::SamplingTime { converter, off_ns });
        }
    }
}

/// The encoder's counter.
pub(super) fn counter(mcu: &Stm32f405) -> i32 {
    mcu.peek(COUNTER).unwrap_or_default().cast_signed()
}

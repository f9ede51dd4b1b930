//! The wiring of the board, and what does not match it.
//!
//! A peripheral sees and drives only pins that are connected to it. Beyond
//! that the board names every mismatch, from the time on at which the
//! bridge's timer runs: that is the last that the image starts.

use super::board_error::BoardError;
use super::coil_driver;
use super::half_bridges::{self, Quiet};
use crate::mcu::Sampling;
use crate::pins::{Mode, Pin, Pull};
use crate::stm32f405::Stm32f405;
use crate::time::{Time, UNITS_PER_S};
use crepitus_device::board::analog::{CLOCK_HZ, INPUTS, Input};
use crepitus_device::board::pins::drive;
use crepitus_device::board::{self, ENCODER_TIMER, LINK_BAUD};

/// Converters of the currents.
const CURRENTS: [u32; 2] = [1, 2];

/// The encoder's counter.
const COUNTER: u32 = ENCODER_TIMER.base + 0x24;

/// Units of time of ten bits, and the most that a receiver stands: 2 %.
const CHARACTER_UNITS: u64 = 10 * UNITS_PER_S / LINK_BAUD as u64;
const MOST_OFF_UNITS: u64 = CHARACTER_UNITS / 50;

/// Time between the middle of a tick and that of all samplings of a current, at most:
/// 0.1 µs.
const MOST_OFF_MIDDLE: Time = Time::from_units(336 / 10);

/// Reports every pin and every switch that does not match.
pub(super) fn check(mcu: &Stm32f405, mut report: impl FnMut(BoardError)) {
    for wire in drive::ALL {
        let (pin, mode) = (Pin::of(wire), Mode::of(wire));
        let is = mcu.pin_setup(pin);
        let pull = match wire.pull {
            board::Pull::Any => None,
            board::Pull::Up => Some(Pull::Up),
            board::Pull::Down => Some(Pull::Down),
        };
        let is_pulled = pull.is_none_or(|pull| pull == is.pull);
        if is.mode != mode || !is_pulled || is.is_open_drain {
            let pull = pull.map(|pull| format!(", {pull}")).unwrap_or_default();
            let named = [wire.part, wire.function];
            let named: Vec<_> = named.into_iter().filter(|it| !it.is_empty()).collect();
            report(BoardError::Pin {
                pin,
                is,
                to: named.join(", "),
                needs: format!("{mode}{pull}"),
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
        let is_wired = |input: &&Input| {
            let pin = Pin::of(&input.connection);
            u32::from(input.converter) == converter && Some(pin) == sampling.pin
        };
        let Some(input) = INPUTS.iter().find(is_wired) else {
            report(BoardError::Channel { converter, channel });
            continue;
        };
        let sampled = sampling.end.units().saturating_sub(sampling.begin.units());
        let needed = u64::from(input.sampling_clocks) * UNITS_PER_S / u64::from(CLOCK_HZ);
        if sampled < needed {
            let [ns, needs_ns] = [sampled, needed].map(|units| units * 1_000 / 336);
            report(BoardError::ShortSampling {
                converter,
                channel,
                ns,
                needs_ns,
            });
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

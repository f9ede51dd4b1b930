//! Causes of each fault here.

mod comms;
mod drive;
mod slow;

use crate::breakage::{
    comms_line_off, drive_line_off, mend_comms_line, mend_drive_line, mend_encoder, nothing, once,
    swap_encoder,
};
use crate::case::Moment::Arming;
use crate::case::{Case, case};
use crate::support::Host;
use crepitus_protocol::management::ResetCause::{Requested, Watchdog};
use crepitus_protocol::telemetry::NO_CURRENT;
use crepitus_protocol::{Fault, LimitReason};
use crepitus_virtual_device::board::Controller::{Comms, Drive};

/// Provocation of a fault.
pub(crate) enum Provocation {
    /// Each of these causes it.
    Cases(Vec<Case>),
    /// The fault cannot be caused here: why.
    None(&'static str),
}

/// Provocation of this fault. A new fault has to find its place.
pub(crate) fn provocation(fault: Fault) -> Provocation {
    Provocation::Cases(match fault {
        Fault::CommsSilent => drive::comms_silent(),
        Fault::LeaseExpired => drive::lease_expired(),
        Fault::CommsRestarted => vec![case(
            "comms is reset, and back at once",
            |host, since| once(since, host, |b| b.reset_for(Comms, Requested, 10)),
            nothing,
        )],
        Fault::EncoderLost => drive::encoder_lost(),
        Fault::Overspeed => vec![drive::overspeed()],
        Fault::SpeedMismatch => drive::speed_mismatch(),
        Fault::EncoderPolarity => {
            vec![case("the encoder is swapped", swap_encoder, mend_encoder).when(Arming)]
        }
        Fault::CurrentOffset => drive::current_offset(),
        Fault::Overcurrent => drive::overcurrent(),
        Fault::CurrentMissing => drive::current_missing(),
        Fault::CurrentMismatch => drive::current_mismatch(),
        Fault::EnableStuckOn => drive::enable_stuck_on(),
        Fault::EnableStuckOff => vec![
            case("while armed", drive_line_off, mend_drive_line),
            case("at arming", drive_line_off, mend_drive_line).when(Arming),
        ],
        Fault::RenderingLate => drive::rendering_late(),
        Fault::CurrentDisagreement => drive::current_disagreement(),
        Fault::CommsLineOff => drive::line_of_comms_unseen(),
        Fault::TickIrregular => drive::tick_irregular(),
        Fault::CurrentWhileFloating => drive::current_while_floating(),
        Fault::SupplyLow => slow::supply_low(),
        Fault::SupplyHigh => slow::supply_high(),
        Fault::MotorHot => slow::motor_hot(),
        Fault::JointMismatch => slow::joint_mismatch(),
        Fault::Overload => slow::overload(),
        Fault::DriveGateStuck => vec![drive::gate_stuck(Drive)],
        Fault::CommsGateStuck => vec![drive::gate_stuck(Comms)],
        Fault::DriveImageBroken
        | Fault::CommsImageBroken
        | Fault::DriveCrystal
        | Fault::CommsCrystal
        | Fault::DriveOptionBytes
        | Fault::CommsOptionBytes => {
            return Provocation::None(
                "there is no flash here: on the drive's image, \
                 `cargo test -p crepitus-emulator --test drive_image self_test`",
            );
        }
        Fault::OutsideRange => vec![drive::outside_range()],
        Fault::NotANumber => {
            return Provocation::None(
                "no count, current or parameter that is let in makes the torque other than finite",
            );
        }
        Fault::DriveWatchdog => drive::drive_watchdog(),
        Fault::DriveBrownOut => vec![drive::brown_out()],
        Fault::DrivePanic => vec![drive::panic()],
        Fault::DriveSilent => comms::drive_silent(),
        Fault::DriveRestarted => vec![reset(
            "the drive is reset, and back at once",
            |host, since| once(since, host, |b| b.reset_for(Drive, Watchdog, 10)),
        )],
        Fault::CommsEnableStuckOn => comms::comms_enable_stuck_on(),
        Fault::CommsEnableStuckOff => vec![
            case("while armed", comms_line_off, mend_comms_line),
            case("while armed, much torque", comms_line_off, mend_comms_line).heavy(),
            case("at arming", comms_line_off, mend_comms_line).when(Arming),
        ],
        Fault::VersionMismatch => vec![comms::version_mismatch()],
        Fault::DriveClock => comms::drive_clock(),
        Fault::CommsOvercurrent => vec![comms::says("it says 2 A", |block| {
            comms::each(block, |sample| sample.current_ma = 2_000);
        })],
        Fault::TorqueBeyondBounds => comms::torque_beyond_bounds(),
        Fault::CurrentBesideTorque => vec![
            comms::says("it says 0.5 A", |block| {
                comms::each(block, |sample| sample.current_ma = 500);
            }),
            comms::says("the same, and that its voltage is at the limit", |block| {
                comms::each(block, |sample| {
                    sample.current_ma = 500;
                    sample.flags = sample.flags.with_limit(LimitReason::Voltage);
                });
            }),
            comms::says("it has no current", |block| {
                comms::each(block, |sample| sample.current_ma = NO_CURRENT);
            }),
        ],
        Fault::TorqueOutsideRange => comms::torque_outside_range(),
        Fault::CommsOverspeed => comms::comms_overspeed(),
        Fault::CommsWatchdog => comms::comms_watchdog(),
        Fault::CommsBrownOut => vec![comms::brown_out()],
        Fault::CommsPanic => vec![comms::panic()],
    })
}

/// Cause that repairs itself.
fn reset(name: &'static str, cause: fn(&mut Host, u64)) -> Case {
    case(name, cause, nothing)
}

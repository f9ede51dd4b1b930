//! Rejected requests as text, with cause and remedy.

use crate::faults::fault_text;
use crate::request_kind::RequestKind;
use crate::values::{allowed_text, full_name, show_value};
use crepitus_protocol::host::Refusal;
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::parameters::{Kind, Parameter, id, with_id};
use crepitus_protocol::{DeviceSettings, ValueError, Values};
use std::fmt;

/// A rejected request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    /// The request.
    pub request: RequestKind,
    /// The reason.
    pub refusal: Refusal,
    /// The values of a commit.
    pub values: Option<Values>,
}

impl std::error::Error for Refused {}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let request = self.request;
        match self.refusal {
            Refusal::Values(error) => self.values_text(f, error),
            Refusal::Stale { revision } => write!(
                f,
                "`{request}` is rejected: the parameters have changed since they were read \
                 (now revision {revision}); read them again"
            ),
            Refusal::Leased { by } => write!(
                f,
                "`{request}` is rejected: another program (session {by}) has armed the device; \
                 end that program, or run `crepitus stop`"
            ),
            Refusal::DriveSilent => write!(
                f,
                "`{request}` is rejected: the drive is silent; \
                 check its power and the cable between the controllers"
            ),
            Refusal::Unconfirmed if request == RequestKind::Commit => f.write_str(
                "timeout: the drive has not confirmed the parameters; it is silent, or still \
                 ramps to the previous ones, and will apply them later; check the status",
            ),
            Refusal::Unconfirmed => write!(
                f,
                "timeout: the drive has not confirmed `{request}` and may have executed it; \
                 check the status"
            ),
            Refusal::Faulted { code } => write!(
                f,
                "`{request}` is rejected because of a fault: {}",
                fault_text(code)
            ),
            Refusal::Armed => needs_disarmed(f, request),
            Refusal::Busy => write!(
                f,
                "`{request}` is rejected: the device is busy with another request, or still ramps \
                 to other parameters; try again"
            ),
            Refusal::Drive(refusal) => drive_text(f, request, refusal),
            Refusal::Storage => f.write_str(
                "the parameters could not be saved: since its start comms has saved as often as its \
                 log has room for, or its flash memory cannot be written; restart the device, which \
                 forgets them, set them again and save",
            ),
            Refusal::NotOpen => write!(
                f,
                "`{request}` is rejected: the device does not know this session; connect again"
            ),
            Refusal::Aborted => {
                write!(f, "`{request}` was aborted by a stop, a disarm or a fault")
            }
        }
    }
}

impl Refused {
    fn values_text(&self, f: &mut fmt::Formatter<'_>, error: ValueError) -> fmt::Result {
        match error {
            ValueError::OutOfRange { id } => {
                write!(f, "invalid value {}", self.setting(id))?;
                if let Some(parameter) = with_id(id) {
                    write!(f, ": must be {}", allowed_text(parameter))?;
                }
            }
            ValueError::KineticAboveStatic => write!(
                f,
                "{} is above {}: lower the first or raise the second",
                self.setting(id::KINETIC_TORQUE),
                self.setting(id::STATIC_TORQUE)
            )?,
            ValueError::Unguarded => {
                write!(
                    f,
                    "{} is too close to {}, with {} and {}: a hand that reverses during a slip would get \
                     more energy than the slip takes out of the spring",
                    self.setting(id::KINETIC_TORQUE),
                    self.setting(id::STATIC_TORQUE),
                    self.setting(id::STIFFNESS),
                    self.setting(id::LINES),
                )?;
                if let Some(values) = &self.values {
                    write!(
                        f,
                        ". One count of the encoder is {:.1} µrad, and may be {:.1} µrad",
                        values.rad_per_count() * 1e6,
                        values.guarded_rad_per_count() * 1e6
                    )?;
                }
                f.write_str(
                    ": lower the kinetic torque or the stiffness, or raise the static torque",
                )?;
            }
            ValueError::Contradiction => {
                match self.values.as_ref().and_then(DeviceSettings::broken_rule) {
                    Some(rule) => write!(f, "{rule}")?,
                    None => f.write_str(
                        "they contradict a rule of the device that this program does not know: \
                         please report these values",
                    )?,
                }
            }
            ValueError::StaticAboveLimit => {
                write!(
                    f,
                    "{} is above {}: lower the first",
                    self.setting(id::STATIC_TORQUE),
                    self.setting(id::TORQUE_LIMIT)
                )?;
                let value = self.values.and_then(|values| values.get(id::STATIC_TORQUE));
                match (with_id(id::TORQUE_LIMIT), value) {
                    (
                        Some(Parameter {
                            kind: Kind::Number(limit),
                            ..
                        }),
                        Some(value),
                    ) if value > limit.max => {
                        write!(f, "; the second is {} {} at most", limit.max, limit.unit)?;
                    }
                    (Some(limit), _) => {
                        write!(f, " or raise the second, which is {}", allowed_text(limit))?;
                    }
                    (None, _) => f.write_str(" or raise the second")?,
                }
            }
            ValueError::NarrowRange => write!(
                f,
                "from {} to {} there is no room for a fade of {} at either end: widen the range or shorten the fade",
                self.setting(id::RANGE_LEAST),
                self.setting(id::RANGE_MOST),
                self.setting(id::RANGE_FADE),
            )?,
            ValueError::NeedsDisarmed { id } => write!(
                f,
                "{} can only change while disarmed: disarm first",
                self.setting(id)
            )?,
        }
        f.write_str("; nothing was changed")
    }

    /// "crepitus.static_torque_nm = 9".
    fn setting(&self, id: u8) -> String {
        let name = name_of(id);
        match (with_id(id), self.values.and_then(|values| values.get(id))) {
            (Some(parameter), Some(value)) => format!("{name} = {}", show_value(parameter, value)),
            _ => name,
        }
    }
}

/// A parameter's name, whatever the id.
pub(crate) fn name_of(id: u8) -> String {
    with_id(id).map_or_else(|| format!("parameter {id}"), full_name)
}

fn needs_disarmed(f: &mut fmt::Formatter<'_>, request: RequestKind) -> fmt::Result {
    if request == RequestKind::Arm {
        f.write_str("`arm` is rejected: the device is armed already")
    } else {
        write!(f, "`{request}` is rejected while armed: disarm first")
    }
}

fn drive_text(
    f: &mut fmt::Formatter<'_>,
    request: RequestKind,
    refusal: DriveRefusal,
) -> fmt::Result {
    match refusal {
        DriveRefusal::NoParameters => write!(
            f,
            "the drive rejects `{request}`: it has no parameters yet; try again in a second"
        ),
        DriveRefusal::NoLease => write!(
            f,
            "the drive rejects `{request}`: the lease has expired; \
             this host is too busy, or the connection too slow"
        ),
        DriveRefusal::Faulted { code } => write!(
            f,
            "the drive rejects `{request}` because of a fault: {}",
            fault_text(code)
        ),
        DriveRefusal::Armed => needs_disarmed(f, request),
        DriveRefusal::NoEncoder => write!(
            f,
            "the drive rejects `{request}`: the encoder's counts are implausible; \
             check its wires and plug"
        ),
        DriveRefusal::Aborted => write!(
            f,
            "the drive has aborted `{request}` because of a stop, a disarm or a fault"
        ),
        DriveRefusal::NotZeroed => write!(
            f,
            "the drive rejects `{request}`: it does not know the angle's zero, without which there is no \
             range of motion; hold the leg straight and set it with `crepitus zero`, or with `--zero` as you arm"
        ),
        DriveRefusal::OutsideRange => write!(
            f,
            "the drive rejects `{request}`: the leg is outside the range of motion, {} to {}; \
             move it inside, or hold it straight and set the zero again",
            name_of(id::RANGE_LEAST),
            name_of(id::RANGE_MOST),
        ),
        DriveRefusal::NotArmed => write!(
            f,
            "`{request}` is rejected: only while armed, by the program that has armed the device"
        ),
        DriveRefusal::NoActuator => write!(
            f,
            "the drive rejects `{request}`: there is no vibration actuator, or its coil has a fault; \
             `crepitus params set vibration-actuator.render=on` turns it on, `crepitus clear-fault` clears the fault"
        ),
        DriveRefusal::ChirpOutOfRange => write!(
            f,
            "the drive rejects `{request}`: the amplitude is above 0.92 of the supply or a current that the sensor can tell, or would drive the mass beyond \
             twice its stroke by the parameters in use, or a frequency or the duration is out of range; lower it"
        ),
        DriveRefusal::ChirpPlaying => write!(
            f,
            "the drive rejects `{request}`: another chirp is being played; wait for its end"
        ),
    }
}

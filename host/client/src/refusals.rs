//! Rejected requests as text, with cause and remedy.

use crate::faults::fault_text;
use crate::request_kind::RequestKind;
use crate::values::{allowed_text, full_name, show_value};
use crepitus_protocol::host::Refusal;
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::parameters::{id, with_id};
use crepitus_protocol::{ValueError, Values};
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
                "`{request}` is refused: the parameters have changed since they were read \
                 (they are at revision {revision} now); read them again"
            ),
            Refusal::Leased { by } => write!(
                f,
                "`{request}` is refused: another host (session {by}) has armed the device; \
                 end that program, or `crepitus stop`"
            ),
            Refusal::DriveSilent => write!(
                f,
                "`{request}` is refused: nothing comes from the drive; \
                 look at its power and at the cable between the controllers"
            ),
            Refusal::Unconfirmed if request == RequestKind::Commit => f.write_str(
                "the drive has not confirmed the parameters in time: it cannot be heard, or still \
                 goes over to those before; they come into force afterwards: ask for the status",
            ),
            Refusal::Unconfirmed => write!(
                f,
                "the drive has not confirmed `{request}` in time, and may have done it: \
                 ask for the status"
            ),
            Refusal::Faulted { code } => write!(
                f,
                "`{request}` is refused, a fault stands in the way: {}",
                fault_text(code)
            ),
            Refusal::Armed => needs_disarmed(f, request),
            Refusal::Busy => write!(
                f,
                "`{request}` is refused: the device still works on another request, or still goes \
                 over to other parameters; try again"
            ),
            Refusal::Drive(refusal) => drive_text(f, request, refusal),
            Refusal::Storage => f.write_str(
                "the parameters could not be kept: the flash memory of comms does not take them; \
                 they are in force until the next start",
            ),
            Refusal::Aborted => {
                write!(
                    f,
                    "`{request}` was given up: a stop, a disarm or a fault came first"
                )
            }
            _ => write!(
                f,
                "`{request}` is refused for a reason that this tool does not know: \
                 install the tool of the device's version"
            ),
        }
    }
}

impl Refused {
    fn values_text(&self, f: &mut fmt::Formatter<'_>, error: ValueError) -> fmt::Result {
        match error {
            ValueError::OutOfRange { id } => {
                write!(f, "{} is not allowed", self.setting(id))?;
                if let Some(parameter) = with_id(id) {
                    write!(f, ": it is {}", allowed_text(parameter))?;
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
                    "{} is too close to {}, with {} and {}: a hand that turns back inside a slip would get \
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
                f.write_str(": lower the kinetic torque or the stiffness, or raise the static torque")?;
            }
            ValueError::Contradiction => f.write_str(
                "the device's own rules contradict each other, a defect of its program: please report these values",
            )?,
            ValueError::StaticAboveLimit => {
                write!(
                    f,
                    "{} is above {}: lower the first or raise the second",
                    self.setting(id::STATIC_TORQUE),
                    self.setting(id::TORQUE_LIMIT)
                )?;
                if let Some(limit) = with_id(id::TORQUE_LIMIT) {
                    write!(f, ", which is {}", allowed_text(limit))?;
                }
            }
            ValueError::NeedsDisarmed { id } => write!(
                f,
                "{} changes only while there is no torque: disarm first",
                self.setting(id)
            )?,
            _ => f.write_str(
                "the values are refused for a reason that this tool does not know: \
                 install the tool of the device's version",
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
        f.write_str("`arm` is refused: the device is armed already")
    } else {
        write!(
            f,
            "`{request}` is refused while there is torque: disarm first"
        )
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
            "the drive refuses `{request}`: it was given no parameters yet; try again in a second"
        ),
        DriveRefusal::NoLease => write!(
            f,
            "the drive refuses `{request}`: the lease was not renewed in time; \
             this host is too busy, or the line too slow"
        ),
        DriveRefusal::Faulted { code } => write!(
            f,
            "the drive refuses `{request}`, a fault stands in the way: {}",
            fault_text(code)
        ),
        DriveRefusal::Armed => needs_disarmed(f, request),
        DriveRefusal::NoEncoder => write!(
            f,
            "the drive refuses `{request}`: the encoder counts more than a shaft can turn; \
             look at its lines and plug"
        ),
        DriveRefusal::Aborted => write!(
            f,
            "the drive has given up `{request}`: a stop, a disarm or a fault came first"
        ),
        _ => write!(
            f,
            "the drive refuses `{request}` for a reason that this tool does not know: \
             install the tool of the device's version"
        ),
    }
}

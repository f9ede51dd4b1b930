//! Faults as text.

use crepitus_protocol::fault::Detector;
use crepitus_protocol::{CoilFault, Fault};

/// A fault's name, detector, cause and remedy.
pub fn fault_text(code: u8) -> String {
    let Some(spec) = Fault::find(code) else {
        return format!(
            "fault {code}, unknown to this tool: install the tool of the device's version"
        );
    };
    let detector = match spec.detector {
        Detector::Drive => "the drive",
        Detector::Comms => "comms",
    };
    format!(
        "{} (fault {code}, detected by {detector}): {}. Remedy: {}",
        spec.name, spec.cause, spec.clear
    )
}

/// A coil fault's name, cause, effect and remedy.
pub fn coil_fault_text(code: u8) -> String {
    CoilFault::find(code).map_or_else(
        || {
            format!(
                "fault {code} of the coil, unknown to this tool: install the tool of the device's version"
            )
        },
        |spec| {
            format!(
                "{} (fault {code} of the coil, detected by the drive): {}. The vibration actuator is off, the motor \
                 goes on. Remedy: {}",
                spec.name, spec.cause, spec.clear
            )
        },
    )
}

//! Faults, said so that a person can mend them.

use crepitus_protocol::Fault;
use crepitus_protocol::fault::Detector;

/// A fault's name, who has noticed it, its cause, and how to go on.
pub fn fault_text(code: u8) -> String {
    let Some(spec) = Fault::find(code) else {
        return format!(
            "fault {code}, which this tool does not know: install the tool of the device's version"
        );
    };
    let detector = match spec.detector {
        Detector::Drive => "the drive",
        Detector::Comms => "comms",
    };
    format!(
        "{} (fault {code}, noticed by {detector}): {}. To go on: {}",
        spec.name, spec.cause, spec.clear
    )
}

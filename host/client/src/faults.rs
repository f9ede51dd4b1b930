//! Faults as text.

use crepitus_protocol::Fault;
use crepitus_protocol::fault::Detector;

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

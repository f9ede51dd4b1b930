//! The device that is calibrated.

use super::finding::{Finding, Verdict};
use crate::failure::Failure;
use crate::line::{Line, failure};
use crepitus_client::Client;
use crepitus_client::connection::device_text;
use crepitus_protocol::State;

/// Identity of the device, and whether it is ready: no fault, not armed.
pub(super) fn found(client: &mut Client<Line>) -> Result<Finding, Failure> {
    let status = client.status().map_err(failure)?;
    let handshake = client.handshake();
    let comms = device_text::identity(&handshake.comms);
    let drive = handshake.drive.as_ref().map(device_text::identity);
    let about = |verdict| {
        Finding::new(None, verdict)
            .remark(format!("comms {comms}"))
            .remark(format!(
                "drive {}",
                drive.as_deref().unwrap_or("has not identified itself")
            ))
    };
    let faults = device_text::faults(&status);
    if !faults.is_empty() {
        return Ok(about(Verdict::Bad)
            .remark(faults.join("; "))
            .remedy("remove the cause, then run `crepitus clear-fault`"));
    }
    if drive.is_none() || !status.drive_present {
        return Ok(about(Verdict::Bad).remedy(
            "check the drive's power and the cable between the controllers: `crepitus doctor`",
        ));
    }
    if status.state != State::Disarmed {
        return Ok(about(Verdict::Bad)
            .remark("another program has armed it")
            .remedy("end that program, or run `crepitus stop`"));
    }
    Ok(about(Verdict::Good).remark("no fault, disarmed"))
}

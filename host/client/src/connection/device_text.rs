//! Identity, status and faults of a device, as text and as JSON.

use crate::connection::times_text;
use crate::{Handshake, coil_fault_text, fault_text};
use crepitus_protocol::counters::{COMMS_COUNTERS, CounterSpec, DRIVE_COUNTERS};
use crepitus_protocol::host::{Counters, Status};
use crepitus_protocol::management::Identity;
use crepitus_protocol::task_times::DeviceTimes;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Formats version, schema hash, serial number and cause of the last reset.
pub fn identity(identity: &Identity) -> String {
    let [major, minor, patch] = identity.version;
    format!(
        "version {major}.{minor}.{patch}, schema {:016x}, serial {}, started by {}",
        identity.schema,
        serial(identity),
        identity.reset.name()
    )
}

/// Returns version, schema hash, serial number, image hash and cause of the last reset as JSON.
pub fn identity_json(identity: &Identity) -> Value {
    let [major, minor, patch] = identity.version;
    json!({
        "version": format!("{major}.{minor}.{patch}"),
        "schema": format!("{:016x}", identity.schema),
        "serial": serial(identity),
        "image": format!("{:08x}", identity.image),
        "reset": identity.reset.name(),
    })
}

/// Formats the chip's serial number: as text if it is printable, else hexadecimal.
pub fn serial(identity: &Identity) -> String {
    let bytes = &identity.serial;
    if bytes.iter().all(u8::is_ascii_graphic) {
        String::from_utf8_lossy(bytes).into_owned()
    } else {
        bytes.iter().fold(String::new(), |mut hex, byte| {
            // Writing to a string does not fail.
            let _ = write!(hex, "{byte:02x}");
            hex
        })
    }
}

/// Returns the text of each active fault.
pub fn faults(status: &Status) -> Vec<String> {
    [status.drive_fault, status.comms_fault]
        .into_iter()
        .filter(|code| *code != 0)
        .map(fault_text)
        .chain((status.coil_fault != 0).then(|| coil_fault_text(status.coil_fault)))
        .collect()
}

/// Returns the status as JSON.
pub fn status_json(status: &Status) -> Value {
    json!({
        "state": status.state.name(),
        "drive_fault": status.drive_fault,
        "comms_fault": status.comms_fault,
        "coil_fault": status.coil_fault,
        "drive_present": status.drive_present,
        "tick": status.tick,
        "uptime_ms": status.uptime_ms,
        "revision": status.revision.0,
        "in_force": status.in_force.0,
        "saved": status.saved.map(|revision| revision.0),
        "lease": status.lease.map(|session| session.to_string()),
        "zeroed": status.zeroed,
        "polarity_proven": status.polarity_proven,
        "supply_v": f64::from(status.measured.supply_cv) / 100.0,
        "motor_c": status.measured.motor_c,
        "joint_span_deg": status.measured.joint_cdeg.map(|cdeg| f64::from(cdeg) / 100.0),
    })
}

/// Returns port, identities, status, faults, counters and times of the tasks as JSON.
pub fn info_json(
    port: &str,
    handshake: &Handshake,
    status: &Status,
    counters: &Counters,
    times: &DeviceTimes,
) -> Value {
    json!({
        "port": port,
        "comms": identity_json(&handshake.comms),
        "drive": handshake.drive.as_ref().map(identity_json),
        "status": status_json(status),
        "faults": faults(status),
        "counters": {
            "drive": counted(&DRIVE_COUNTERS, &counters.drive),
            "comms": counted(&COMMS_COUNTERS, &counters.comms),
        },
        "times": times_text::json(handshake, times),
    })
}

fn counted(specs: &[CounterSpec], counts: &[u32]) -> Map<String, Value> {
    specs
        .iter()
        .zip(counts)
        .map(|(spec, count)| (spec.name.to_owned(), json!(count)))
        .collect()
}

//! `crepitus info`: who a device is, how it is, what it has counted.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{Line, failure, manage};
use crate::told;
use clap::Args;
use crepitus_client::{Client, Error, Handshake};
use crepitus_protocol::counters::{COMMS_COUNTERS, CounterSpec, DRIVE_COUNTERS};
use crepitus_protocol::host::{Counters, Status};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Show who a device is, how it is, and what it has counted.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus info
  crepitus info --device sim --json")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

/// Shows a device.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut management = manage(&arguments.device)?;
    let handshake = management.identify().map_err(failure)?;
    match management.into_client(handshake) {
        Ok(mut client) => known(&mut client, &handshake, as_json),
        Err(Error::Mismatch(mismatch)) => {
            // Who is there can be said of any version.
            if as_json {
                print_json(&json!({
                    "comms": told::identity_json(&handshake.comms),
                    "drive": handshake.drive.as_ref().map(told::identity_json),
                    "mismatch": mismatch.to_string(),
                }))?;
            } else {
                print(&who(&handshake))?;
            }
            Err(Failure::Work(mismatch.to_string()))
        }
        Err(error) => Err(failure(error)),
    }
}

fn who(handshake: &Handshake) -> String {
    let drive = handshake
        .drive
        .as_ref()
        .map_or_else(|| "has not said who it is".to_owned(), told::identity);
    format!(
        "comms   {}\ndrive   {drive}\n",
        told::identity(&handshake.comms)
    )
}

fn known(client: &mut Client<Line>, handshake: &Handshake, as_json: bool) -> Result<(), Failure> {
    let status = client.status().map_err(failure)?;
    let counters = client.counters().map_err(failure)?;
    if as_json {
        return print_json(&json!({
            "port": client.port(),
            "comms": told::identity_json(&handshake.comms),
            "drive": handshake.drive.as_ref().map(told::identity_json),
            "status": told::status_json(&status),
            "faults": told::faults(&status),
            "counters": {
                "drive": counted(&DRIVE_COUNTERS, &counters.drive),
                "comms": counted(&COMMS_COUNTERS, &counters.comms),
            },
        }));
    }
    let mut text = format!("port    {}\n{}", client.port(), who(handshake));
    text.push_str(&how(&status));
    text.push_str(&counter_table(&counters));
    print(&text)
}

fn how(status: &Status) -> String {
    let mut text = format!("state   {}", status.state.name());
    if !status.drive_present {
        text.push_str(", nothing comes from the drive");
    }
    text.push('\n');
    for fault in told::faults(status) {
        let _ = writeln!(text, "fault   {fault}");
    }
    let saved = match status.saved {
        Some(saved) if saved == status.revision => "kept".to_owned(),
        Some(saved) => format!("revision {saved} is kept"),
        None => "none is kept".to_owned(),
    };
    let _ = writeln!(
        text,
        "params  revision {}, {} in force at the drive, {saved}",
        status.revision,
        if status.in_force == status.revision {
            "which is".to_owned()
        } else {
            format!("and {} is", status.in_force)
        }
    );
    let _ = writeln!(
        text,
        "angle   {}",
        if status.zeroed {
            "zero was set"
        } else {
            "zero was not set: counts begin where the device was switched on"
        }
    );
    let lease = status
        .lease
        .map_or("nobody's".to_owned(), |session| format!("host {session}'s"));
    let _ = writeln!(text, "lease   {lease}");
    text
}

fn counter_table(counters: &Counters) -> String {
    let mut text = String::new();
    let lists: [(&str, &[CounterSpec], &[u32]); 2] = [
        ("drive", &DRIVE_COUNTERS, &counters.drive),
        ("comms", &COMMS_COUNTERS, &counters.comms),
    ];
    for (who, specs, counts) in lists {
        let _ = writeln!(text, "\ncounted by {who}");
        for (spec, count) in specs.iter().zip(counts) {
            let _ = writeln!(text, "  {count:>10}  {}", spec.name);
        }
    }
    text
}

fn counted(specs: &[CounterSpec], counts: &[u32]) -> Map<String, Value> {
    specs
        .iter()
        .zip(counts)
        .map(|(spec, count)| (spec.name.to_owned(), json!(count)))
        .collect()
}

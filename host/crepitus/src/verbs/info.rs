//! `crepitus info`: identity, status, counters and times of the tasks of a device.

use crate::cli::DeviceArguments;
use crate::crash_text;
use crate::failure::{Failure, print, print_json};
use crate::line::{Line, failure, manage};
use clap::Args;
use crepitus_client::connection::{device_text, times_text};
use crepitus_client::{Client, Error, Handshake};
use crepitus_protocol::Revision;
use crepitus_protocol::counters::{COMMS_COUNTERS, CounterSpec, DRIVE_COUNTERS};
use crepitus_protocol::crash::Controller;
use crepitus_protocol::host::{Counters, Status};
use serde_json::json;
use std::fmt::Write as _;

/// Show identity, status, counters and times of the tasks of a device.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus info
  crepitus info --crash
  crepitus info --device sim --json")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,

    /// Show how a program of the device crashed last: registers, stack, last ticks
    #[arg(long)]
    crash: bool,
}

/// Prints them.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut management = manage(&arguments.device)?;
    let handshake = management.identify().map_err(failure)?;
    match management.into_client(handshake) {
        Ok(mut client) if arguments.crash => print_crash(&mut client, as_json),
        Ok(mut client) => print_all(&mut client, &handshake, as_json),
        Err(Error::Mismatch(mismatch)) => {
            // The identity is known for any version.
            if as_json {
                print_json(&json!({
                    "comms": device_text::identity_json(&handshake.comms),
                    "drive": handshake.drive.as_ref().map(device_text::identity_json),
                    "mismatch": mismatch.to_string(),
                }))?;
            } else {
                print(&identity_text(&handshake))?;
            }
            Err(Failure::Work(mismatch.to_string()))
        }
        Err(error) => Err(failure(error)),
    }
}

fn identity_text(handshake: &Handshake) -> String {
    let drive = handshake.drive.as_ref().map_or_else(
        || "has not identified itself".to_owned(),
        device_text::identity,
    );
    format!(
        "comms   {}\ndrive   {drive}\n",
        device_text::identity(&handshake.comms)
    )
}

/// Prints the post-mortem record of each controller.
fn print_crash(client: &mut Client<Line>, as_json: bool) -> Result<(), Failure> {
    let comms = client.crash(Controller::Comms).map_err(failure)?;
    let drive = client.crash(Controller::Drive).map_err(failure)?;
    if as_json {
        return print_json(&json!({
            "comms": crash_text::json(comms.as_ref()),
            "drive": crash_text::json(drive.as_ref()),
        }));
    }
    print(&format!(
        "{}{}",
        crash_text::text("comms", comms.as_ref()),
        crash_text::text("drive", drive.as_ref())
    ))
}

fn print_all(
    client: &mut Client<Line>,
    handshake: &Handshake,
    as_json: bool,
) -> Result<(), Failure> {
    let status = client.status().map_err(failure)?;
    let counters = client.counters().map_err(failure)?;
    let times = client.times().map_err(failure)?;
    if as_json {
        let port = client.port();
        return print_json(&device_text::info_json(
            &port, handshake, &status, &counters, &times,
        ));
    }
    let mut text = format!("port    {}\n{}", client.port(), identity_text(handshake));
    text.push_str(&status_text(&status));
    text.push_str(&counter_table(&counters));
    text.push_str(&times_text::table(handshake, &times));
    print(&text)
}

fn status_text(status: &Status) -> String {
    let mut text = format!("state   {}", status.state.name());
    if !status.drive_present {
        text.push_str(", no messages from the drive");
    }
    text.push('\n');
    for fault in device_text::faults(status) {
        let _ = writeln!(text, "fault   {fault}");
    }
    let saved = match status.saved {
        Some(saved) if saved == status.revision => "saved".to_owned(),
        Some(saved) => format!("revision {saved} is saved"),
        None => "none is saved".to_owned(),
    };
    let _ = writeln!(
        text,
        "params  revision {}, {}, {saved}",
        status.revision,
        match status.in_force {
            applied if applied == status.revision => "applied by the drive".to_owned(),
            Revision::NONE => "which the drive has not got yet".to_owned(),
            applied => format!("the drive still applies {applied}"),
        }
    );
    let _ = writeln!(
        text,
        "angle   {}",
        if status.zeroed {
            "zero is set"
        } else {
            "zero is not set: counts start where the device was switched on"
        }
    );
    let measured = &status.measured;
    let _ = writeln!(
        text,
        "motor   supply {:.1} V, {} °C",
        f64::from(measured.supply_cv) / 100.0,
        measured.motor_c
    );
    let _ = writeln!(
        text,
        "joint   {}",
        measured.joint_cdeg.map_or(
            "no sensor of its own, or no zero: a coupling that slips is not detected".to_owned(),
            |cdeg| format!(
                "sensor and encoder have differed by up to {:.2} deg since the zero, backlash in it",
                f64::from(cdeg) / 100.0
            )
        )
    );
    let lease = status.lease.map_or("none".to_owned(), |session| {
        format!("held by host {session}")
    });
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
        let _ = writeln!(text, "\ncounters of {who}");
        for (spec, count) in specs.iter().zip(counts) {
            let _ = writeln!(text, "  {count:>10}  {}", spec.name);
        }
    }
    text
}

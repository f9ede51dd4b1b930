//! `crepitus doctor`: everything between this program and the motor, one after
//! the other.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{Line, connect};
use crate::told;
use clap::Args;
use crepitus_client::{Client, Event, RequestKind};
use crepitus_protocol::TICKS_PER_S;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::telemetry::{NO_CURRENT, SampleFlags};
use serde_json::json;
use std::time::Duration;

/// Examine a device: what is wrong, and what to do about it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus doctor
  crepitus doctor --device sim

Looks at everything between this program and the motor, one after the other, and says what to do \
about what is not in order. Nothing moves: the device is not armed. The exit code is 1 if \
something is wrong.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

/// How long telemetry is listened to.
const LISTEN: Duration = Duration::from_secs(1);

/// Requests whose answers are timed.
const ROUND_TRIPS: u32 = 50;

/// An answer that takes longer says that something is slow, ms.
const SLOW_MS: f64 = 50.0;

/// What was looked at.
struct Check {
    what: &'static str,
    /// What was found; if it is not in order, what to do.
    found: String,
    is_fine: bool,
}

/// Examines a device.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut checks = Vec::new();
    match connect(&arguments.device) {
        Ok(mut client) => {
            let handshake = *client.handshake();
            let comms = told::identity(&handshake.comms);
            checks.push(fine("line", client.port()));
            checks.push(fine("comms", comms));
            if let Err(error) = examine(&mut client, &mut checks) {
                checks.push(wrong("device", error.to_string()));
            }
        }
        Err(Failure::Input(text) | Failure::Work(text)) => checks.push(wrong("line", text)),
        Err(other) => return Err(other),
    }
    let is_fine = checks.iter().all(|check| check.is_fine);
    if as_json {
        let list: Vec<_> = checks
            .iter()
            .map(|c| json!({ "what": c.what, "found": c.found, "fine": c.is_fine }))
            .collect();
        print_json(&json!({ "fine": is_fine, "checks": list }))?;
    } else {
        let lines = checks.iter().map(|c| {
            let mark = if c.is_fine { "ok   " } else { "WRONG" };
            format!(
                "{mark} {:<11} {}\n",
                c.what,
                c.found.replace('\n', "\n                  ")
            )
        });
        print(&lines.collect::<String>())?;
    }
    if is_fine {
        Ok(())
    } else {
        Err(Failure::Negative)
    }
}

fn fine(what: &'static str, found: impl Into<String>) -> Check {
    Check {
        what,
        found: found.into(),
        is_fine: true,
    }
}

fn wrong(what: &'static str, found: impl Into<String>) -> Check {
    Check {
        what,
        found: found.into(),
        is_fine: false,
    }
}

fn examine(
    client: &mut Client<Line>,
    checks: &mut Vec<Check>,
) -> Result<(), crepitus_client::Error> {
    let handshake = *client.handshake();
    let status = client.status()?;
    checks.push(match (&handshake.drive, status.drive_present) {
        (_, false) => wrong(
            "drive",
            "nothing comes from it: is it powered, and is the link (PC6, PC7) connected?",
        ),
        (None, true) => wrong("drive", "it sends samples and does not say who it is"),
        (Some(drive), true) => fine("drive", told::identity(drive)),
    });
    if let Some(mismatch) = handshake.mismatch() {
        checks.push(wrong("language", mismatch.to_string()));
    }
    let faults = told::faults(&status);
    checks.push(if faults.is_empty() {
        fine("faults", "none")
    } else {
        wrong("faults", faults.join("\n"))
    });
    checks.push(if status.in_force == status.revision {
        let kept = match status.saved {
            Some(saved) if saved == status.revision => "kept",
            _ => "not kept for the next start",
        };
        fine(
            "parameters",
            format!("revision {} in force, {kept}", status.revision),
        )
    } else {
        wrong(
            "parameters",
            format!(
                "the drive has revision {}, and revision {} was committed: it takes them over once \
                 it is heard",
                status.in_force, status.revision
            ),
        )
    });
    round_trips(client, checks)?;
    telemetry(client, checks)?;
    wires(client, checks)
}

fn round_trips(
    client: &mut Client<Line>,
    checks: &mut Vec<Check>,
) -> Result<(), crepitus_client::Error> {
    for _ in 0..ROUND_TRIPS {
        client.status()?;
    }
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    if let Some(trip) = client.round_trips().of(RequestKind::Status) {
        let text = format!(
            "median {:.2} ms, worst {:.2} ms",
            ms(trip.median),
            ms(trip.worst)
        );
        checks.push(if ms(trip.median) < SLOW_MS {
            fine("round trip", text)
        } else {
            wrong(
                "round trip",
                format!("{text}: is the computer busy, or a hub between?"),
            )
        });
    }
    Ok(())
}

fn telemetry(
    client: &mut Client<Line>,
    checks: &mut Vec<Check>,
) -> Result<(), crepitus_client::Error> {
    client.subscribe()?;
    let end = client.now() + LISTEN;
    let (mut lost, mut late, mut unmeasured) = (0_u32, 0_u32, 0_u32);
    while client.now() < end {
        let Some(event) = client.pump(Duration::from_millis(20))? else {
            continue;
        };
        if let Event::Block(arrival) = event {
            for sample in &arrival.block.samples {
                lost += u32::from(sample.flags.has(SampleFlags::LOST));
                late += u32::from(sample.flags.has(SampleFlags::LATE));
                unmeasured += u32::from(sample.current_ma == NO_CURRENT);
            }
        }
    }
    let (received, dropped) = client
        .accounting()
        .map_or((0, 0), |books| (books.received(), books.dropped()));
    client.unsubscribe()?;
    let text = format!("{received} samples in a second, {dropped} dropped");
    let enough = received + dropped > u64::from(TICKS_PER_S) * 9 / 10;
    checks.push(if enough && dropped == 0 {
        fine("samples", text)
    } else {
        wrong(
            "samples",
            format!("{text}, of {TICKS_PER_S}: is the computer busy, or a hub between?"),
        )
    });
    for (what, count, remedy) in [
        (
            "encoder",
            lost,
            "counts that no shaft makes: look at its line and shield",
        ),
        (
            "current",
            unmeasured,
            "ticks without a measured current: look at the converter",
        ),
        (
            "rendering",
            late,
            "late ticks: the program is too slow for its tick",
        ),
    ] {
        checks.push(if count == 0 {
            fine(what, "in order")
        } else {
            wrong(what, format!("{count} {remedy}"))
        });
    }
    Ok(())
}

/// What was thrown away on the wires since the start.
fn wires(client: &mut Client<Line>, checks: &mut Vec<Check>) -> Result<(), crepitus_client::Error> {
    let counters = client.counters()?;
    let drive = |counter: DriveCounter| counters.drive.get(counter.index()).copied().unwrap_or(0);
    let comms = |counter: CommsCounter| counters.comms.get(counter.index()).copied().unwrap_or(0);
    let discarded = drive(DriveCounter::Discarded) + comms(CommsCounter::FromDriveDiscarded);
    let frames = drive(DriveCounter::Frames) + comms(CommsCounter::FromDrive);
    let text = format!("{frames} frames in order, {discarded} thrown away");
    // One a thousand is noise that repeats take care of.
    checks.push(if discarded <= frames / 1000 {
        fine("link", text)
    } else {
        wrong(
            "link",
            format!("{text}: look at the cable between the controllers"),
        )
    });
    Ok(())
}

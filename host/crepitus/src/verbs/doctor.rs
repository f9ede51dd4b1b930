//! `crepitus doctor`: checks of everything between this program and the motor.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{Line, connect};
use clap::Args;
use crepitus_client::connection::{device_text, times_text};
use crepitus_client::{Client, Event, RequestKind};
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::friction_compensation::FrictionCompensationSettings;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::Status;
use crepitus_protocol::measured::{MOTOR_C, SUPPLY_SHARES};
use crepitus_protocol::parameters::id;
use crepitus_protocol::telemetry::{NO_CURRENT, SampleFlags};
use crepitus_protocol::{TICKS_PER_S, Values};
use serde_json::json;
use std::time::Duration;

/// Check a device: what is wrong, and what to do about it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus doctor
  crepitus doctor --device sim

Checks everything between this program and the motor in turn, and says how to fix what is wrong. \
Nothing moves: the device is not armed. The exit code is 1 if a check fails.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

/// Duration of the telemetry check.
const LISTEN: Duration = Duration::from_secs(1);

/// Requests of the latency check.
const ROUND_TRIPS: u32 = 50;

/// A longer median round trip is a problem, ms.
const SLOW_MS: f64 = 50.0;

/// One check.
struct Check {
    what: &'static str,
    /// The finding; if there is a problem, what to do.
    found: String,
    is_fine: bool,
}

/// Runs the checks.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut checks = Vec::new();
    match connect(&arguments.device) {
        Ok(mut client) => {
            let handshake = *client.handshake();
            let comms = device_text::identity(&handshake.comms);
            checks.push(fine("line", client.port()));
            checks.push(fine("comms", comms));
            if let Err(error) = check(&mut client, &mut checks) {
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

fn check(client: &mut Client<Line>, checks: &mut Vec<Check>) -> Result<(), crepitus_client::Error> {
    let handshake = *client.handshake();
    let status = client.status()?;
    checks.push(match (&handshake.drive, status.drive_present) {
        (_, false) => wrong(
            "drive",
            "no messages: check its power and the link (PC6, PC7)",
        ),
        (None, true) => wrong(
            "drive",
            "it sends samples but has not identified itself: restart the device",
        ),
        (Some(drive), true) => fine("drive", device_text::identity(drive)),
    });
    if let Some(mismatch) = handshake.mismatch() {
        checks.push(wrong("schema", mismatch.to_string()));
    }
    let faults = device_text::faults(&status);
    checks.push(if faults.is_empty() {
        fine("faults", "none")
    } else {
        wrong("faults", faults.join("\n"))
    });
    checks.push(if status.in_force == status.revision {
        let saved = match status.saved {
            Some(saved) if saved == status.revision => "saved",
            _ => "not saved for the next start",
        };
        fine(
            "parameters",
            format!("revision {}, {saved}", status.revision),
        )
    } else {
        wrong(
            "parameters",
            format!(
                "the drive has not applied revision {}, which was committed: check the link between the \
                 controllers",
                status.revision
            ),
        )
    });
    if status.drive_present {
        motor(client, &status, checks)?;
    }
    round_trips(client, checks)?;
    telemetry(client, checks)?;
    times(client, checks)?;
    wires(client, checks)
}

/// Checks what the drive measures beside the motion, and what arming needs.
fn motor(
    client: &mut Client<Line>,
    status: &Status,
    checks: &mut Vec<Check>,
) -> Result<(), crepitus_client::Error> {
    let (_, values) = client.parameters()?;
    let measured = &status.measured;
    let supply_v = f64::from(measured.supply_cv) / 100.0;
    let expected_v = values.get(id::SUPPLY).unwrap_or_default();
    let (least, most) = SUPPLY_SHARES;
    let text = format!("{supply_v:.1} V, expected {expected_v:.1} V");
    checks.push(
        if (least * expected_v..=most * expected_v).contains(&supply_v) {
            fine("supply", text)
        } else {
            wrong(
                "supply",
                format!(
                    "{text}: is it on, is the hand-held stop released, is motor.supply_v right?"
                ),
            )
        },
    );
    let text = format!("{} °C", measured.motor_c);
    let (coldest, hottest) = MOTOR_C;
    checks.push(
        if (coldest..hottest).contains(&f32::from(measured.motor_c)) {
            fine("motor", text)
        } else {
            wrong(
                "motor",
                format!("{text}: too hot, or its sensor is not there"),
            )
        },
    );
    checks.push(fine(
        "angle",
        if status.zeroed {
            "zero is set"
        } else {
            "zero is not set, which arming needs: `crepitus zero` with the leg straight"
        },
    ));
    checks.push(fine("friction", friction(&values)));
    Ok(())
}

/// The part of the gear's friction that the hand feels beside the joint, and how to feel less of it. A brace that is not
/// calibrated yet has no compensation, and nothing is wrong with it.
fn friction(values: &Values) -> String {
    let gear: FrictionCompensationSettings = values.read();
    let is_on = values.is_on(id::COMPENSATION);
    let share = if is_on { gear.share } else { 0.0 };
    let text = format!(
        "{:.2} of the gear's {:.2} N·m are felt beside the joint",
        (1.0 - share) * gear.friction_nm,
        gear.friction_nm
    );
    if is_on {
        text
    } else {
        format!(
            "{text}, as its compensation is off: measure it and switch that on with `crepitus calibrate --apply` and a \
             weight that swings"
        )
    }
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
                format!("{text}: close other programs, connect without a USB hub"),
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
    let (received, dropped) = client.accounting().map_or((0, 0), |accounting| {
        (accounting.received(), accounting.dropped())
    });
    client.unsubscribe()?;
    let text = format!("{received} samples in a second, {dropped} dropped");
    let enough = received + dropped > u64::from(TICKS_PER_S) * 9 / 10;
    checks.push(if enough && dropped == 0 {
        fine("samples", text)
    } else {
        wrong(
            "samples",
            format!(
                "{text}, expected {TICKS_PER_S}: close other programs, connect without a USB hub"
            ),
        )
    });
    for (what, count, remedy) in [
        (
            "encoder",
            lost,
            "implausible counts: check its cable and shield",
        ),
        (
            "current",
            unmeasured,
            "ticks without a current measurement: check the converter",
        ),
        (
            "rendering",
            late,
            "late ticks: the firmware is too slow for its tick",
        ),
    ] {
        checks.push(if count == 0 {
            fine(what, "ok")
        } else {
            wrong(what, format!("{count} {remedy}"))
        });
    }
    Ok(())
}

/// Times of the tasks; a stack that is nearly full is a problem. Late ticks are one by themselves.
fn times(client: &mut Client<Line>, checks: &mut Vec<Check>) -> Result<(), crepitus_client::Error> {
    let handshake = *client.handshake();
    let times = client.times()?;
    let all = [times.drive, times.comms];
    for ((who, text), times) in times_text::summaries(&handshake, &times)
        .into_iter()
        .zip(all)
    {
        let what = if who == "drive" {
            "drive times"
        } else {
            "comms times"
        };
        let is_full = times.is_some_and(|times| times.stack_used > times.stack_bytes / 8 * 7);
        checks.push(if is_full {
            wrong(what, format!("{text}: the stack is nearly full"))
        } else {
            fine(what, text)
        });
    }
    Ok(())
}

/// Frames discarded on the link since the start.
fn wires(client: &mut Client<Line>, checks: &mut Vec<Check>) -> Result<(), crepitus_client::Error> {
    let counters = client.counters()?;
    let drive = |counter: DriveCounter| counters.drive.get(counter.index()).copied().unwrap_or(0);
    let comms = |counter: CommsCounter| counters.comms.get(counter.index()).copied().unwrap_or(0);
    let discarded = drive(DriveCounter::Discarded) + comms(CommsCounter::FromDriveDiscarded);
    let frames = drive(DriveCounter::Frames) + comms(CommsCounter::FromDrive);
    let text = format!("{frames} frames received, {discarded} discarded");
    // One in a thousand is noise; retries cover it.
    checks.push(if discarded <= frames / 1000 {
        fine("link", text)
    } else {
        wrong(
            "link",
            format!("{text}: check the cable between the controllers"),
        )
    });
    Ok(())
}

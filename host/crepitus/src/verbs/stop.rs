//! `crepitus stop`.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json, warn};
use crate::line::{attached, failure, manage_to_stop, named};
use clap::Args;
use crepitus_client::sharing::Program;
use serde_json::json;
use std::thread;

/// Turn torque off, on a device of any version.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stop
  crepitus stop --device /dev/ttyACM0

Without --device it stops every device that is attached. Like disarm, but whichever program has armed the device, and through the part of the protocol that \
never changes, so it works with a device of any version. It says who had armed it. It is no substitute for the hand-held stop.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let devices = attached(&arguments.device)?;
    // At once: one that does not answer must not delay another's stop.
    let stopped: Vec<_> = thread::scope(|scope| {
        let stops: Vec<_> = devices
            .iter()
            .map(|device| scope.spawn(|| stop(device)))
            .collect();
        stops
            .into_iter()
            .map(thread::ScopedJoinHandle::join)
            .collect()
    });
    let mut armed = Vec::new();
    let mut failed = None;
    for result in stopped {
        match result {
            Ok(Ok(programs)) => armed.extend(programs),
            Ok(Err(failure)) => {
                if let Some(Failure::Input(text) | Failure::Work(text)) = failed.replace(failure) {
                    warn(text);
                }
            }
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
    if let Some(failure) = failed {
        return Err(failure);
    }
    if as_json {
        return print_json(&json!({ "done": "stopped", "armed": armed }));
    }
    let of_several = match devices.len() {
        1 => String::new(),
        number => format!(" {number} devices"),
    };
    let armed: Vec<_> = armed
        .iter()
        .map(|program| format!("; {} had armed it", named(program).trim_end_matches(',')))
        .collect();
    print(&format!("stopped{of_several}{}\n", armed.concat()))
}

/// Stops a device; returns the programs that had armed it.
fn stop(device: &DeviceArguments) -> Result<Vec<Program>, Failure> {
    let mut management = manage_to_stop(device)?;
    management.stop().map_err(failure)?;
    // After the stop: nothing may delay it.
    let mut programs = management.transport_mut().programs();
    programs.retain(|program| program.is_armed);
    Ok(programs)
}

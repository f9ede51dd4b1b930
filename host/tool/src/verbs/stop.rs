//! `crepitus stop`.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{failure, manage, named};
use clap::Args;
use serde_json::json;

/// Turn torque off, on a device of any version.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stop
  crepitus stop --device /dev/ttyACM0

Like disarm, but whichever program has armed the device, and through the part of the protocol that \
never changes, so it works with a device of any version. It says who had armed it. It is no substitute for the hand-held stop.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut management = manage(&arguments.device)?;
    management.stop().map_err(failure)?;
    // After the stop: nothing may delay it.
    let mut programs = management.transport_mut().programs();
    programs.retain(|program| program.is_armed);
    if as_json {
        return print_json(&json!({ "done": "stopped", "armed": programs }));
    }
    let armed: Vec<_> = programs
        .iter()
        .map(|program| format!("; {} had armed it", named(program).trim_end_matches(',')))
        .collect();
    print(&format!("stopped{}\n", armed.concat()))
}

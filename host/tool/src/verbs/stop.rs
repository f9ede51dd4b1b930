//! `crepitus stop`.

use crate::cli::DeviceArguments;
use crate::device_command::print_done;
use crate::failure::Failure;
use crate::line::{failure, manage};
use clap::Args;

/// Turn torque off, on a device of any version.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stop
  crepitus stop --device /dev/ttyACM0

Like disarm, but through the part of the protocol that never changes, so it works with a device of \
any version. It is no substitute for the hand-held stop.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    manage(&arguments.device)?.stop().map_err(failure)?;
    print_done("stopped", as_json)
}

//! `crepitus clear-fault`.

use crate::cli::DeviceArguments;
use crate::device_command::execute;
use crate::failure::Failure;
use clap::Args;
use crepitus_client::Client;

/// Forget the faults of a device.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus clear-fault

Faults latch: see what it was with `crepitus info`, mend it, then clear it. That works only while \
the bridge floats.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    execute(&arguments.device, "no fault", as_json, Client::clear_fault)
}

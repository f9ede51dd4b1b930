//! `crepitus clear-fault`.

use crate::cli::DeviceArguments;
use crate::device_command::execute;
use crate::failure::Failure;
use clap::Args;
use crepitus_client::Client;

/// Clear a device's faults.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus clear-fault

Faults latch: find the cause with `crepitus info`, remove it, then clear the fault. A fault can be \
cleared only while the bridge is off.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    execute(
        &arguments.device,
        "faults cleared",
        as_json,
        Client::clear_fault,
    )
}

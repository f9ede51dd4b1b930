//! `crepitus disarm`.

use crate::cli::DeviceArguments;
use crate::device_command::execute;
use crate::failure::Failure;
use clap::Args;
use crepitus_client::Client;

/// Turn torque off.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus disarm
  crepitus disarm --device /dev/ttyACM0")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    execute(&arguments.device, "disarmed", as_json, Client::disarm)
}

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
  crepitus disarm --device /dev/ttyACM0
  crepitus disarm --force")]
pub(crate) struct Arguments {
    /// Also if another program has armed the device.
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let request = if arguments.force {
        Client::stop
    } else {
        Client::disarm
    };
    execute(&arguments.device, "disarmed", as_json, request)
}

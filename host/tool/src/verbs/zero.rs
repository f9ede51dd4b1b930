//! `crepitus zero`.

use crate::cli::DeviceArguments;
use crate::device_command::execute;
use crate::failure::Failure;
use clap::Args;
use crepitus_client::Client;

/// Tell a device that the joint's angle is zero now.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus zero
  crepitus zero --device /dev/ttyACM0

Hold the joint straight first: counts are counted from here.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    execute(
        &arguments.device,
        "the angle is zero here",
        as_json,
        Client::zero,
    )
}

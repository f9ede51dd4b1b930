//! `crepitus zero`.

use crate::cli::DeviceArguments;
use crate::device_command::execute;
use crate::failure::Failure;
use clap::Args;
use crepitus_client::Client;

/// Set the joint's current angle as zero.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus zero
  crepitus zero --device /dev/ttyACM0

Hold the joint straight first: the encoder counts from here.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceArguments,
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    execute(&arguments.device, "zero set", as_json, Client::zero)
}

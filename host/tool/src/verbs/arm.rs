//! `crepitus arm`.

use crate::cli::{DeviceArguments, duration};
use crate::device_command::print_done;
use crate::failure::Failure;
use crate::following::{End, Follower, follow};
use crate::keys::Keys;
use crate::line::{Line, connect};
use clap::Args;
use crepitus_client::Client;
use crepitus_protocol::telemetry::Block;
use std::time::Duration;

/// Have torque rendered, as long as this command runs.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus arm --for 60s
  crepitus arm --device sim --for 2s

The torque is there as long as this command runs: it holds the lease. Any key or Ctrl-C disarms; \
if this program is killed, the device lets go within 250 ms by itself.")]
pub(crate) struct Arguments {
    /// How long: 30s, 5m [default: until a key is pressed].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    for_s: Option<Duration>,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Holds the lease until a key is pressed.
struct Holding {
    keys: Option<Keys>,
}

impl Follower for Holding {
    fn block(&mut self, _: &mut Client<Line>, _: &Block) -> Result<(), Failure> {
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        // Only once it is armed, so that a refusal is printed as ever.
        let keys = self.keys.get_or_insert_with(|| {
            let is_armed = if client.is_armed() {
                "armed"
            } else {
                "not armed"
            };
            eprintln!("{is_armed}: any key disarms");
            Keys::listen()
        });
        Ok(keys.are_heard() && keys.pressed())
    }
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let mut client = connect(&arguments.device)?;
    let mut holding = Holding { keys: None };
    let end = follow(&mut client, arguments.for_s, true, &mut holding);
    // The terminal first, then what is to be said.
    drop(holding);
    let done = match end? {
        End::Time => "disarmed: the time is over",
        End::Asked => "disarmed",
    };
    print_done(done, as_json)
}

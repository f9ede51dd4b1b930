//! `crepitus arm`.

use crate::cli::{Arming, DeviceArguments, duration};
use crate::device_command::print_done;
use crate::failure::Failure;
use crate::following::{End, Follower, follow};
use crate::interrupt;
use crate::keys::Keys;
use crate::line::{Line, connect_to_arm};
use clap::Args;
use crepitus_client::Client;
use crepitus_protocol::telemetry::Block;
use std::io::{IsTerminal, Write, stderr, stdin};
use std::time::Duration;

/// Turn torque on while this command runs.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus arm --zero
  crepitus arm --for 60s
  crepitus arm --device sim --zero --for 2s

The drive needs the angle's zero, from which its range of motion counts: with the leg held straight, \
--zero sets it, as does `crepitus zero`; it is kept until the drive restarts or its encoder is in doubt.

Torque stays on while this command renews its lease. Any key or Ctrl-C disarms; if this program is \
killed, the lease expires and the device disarms within 250 ms.")]
pub(crate) struct Arguments {
    /// Duration: 30s, 5m [default: until a key is pressed].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    for_s: Option<Duration>,

    /// Set the angle's zero before: hold the leg straight.
    #[arg(long)]
    zero: bool,

    #[command(flatten)]
    device: DeviceArguments,
}

/// Stops at a key press; the lease is renewed meanwhile.
struct UntilKey {
    keys: Option<Keys>,
}

impl Follower for UntilKey {
    fn block(&mut self, _: &mut Client<Line>, _: &Block) -> Result<(), Failure> {
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        // After arming, so that an error is printed in the normal mode.
        let keys = self.keys.get_or_insert_with(|| {
            let is_armed = if client.is_armed() {
                "armed"
            } else {
                "not armed"
            };
            let how = if stdin().is_terminal() {
                "any key"
            } else {
                "Ctrl-C"
            };
            // Without anybody who reads, too.
            let _ = writeln!(stderr(), "{is_armed}: {how} disarms");
            Keys::listen()
        });
        Ok(keys.is_active() && keys.pressed())
    }
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    interrupt::listen();
    let arming = Arming::armed(arguments.zero);
    let mut client = connect_to_arm(&arguments.device, arming)?;
    let mut until_key = UntilKey { keys: None };
    let end = follow(&mut client, arguments.for_s, arming, &mut until_key);
    // Restores the terminal before anything is printed.
    drop(until_key);
    let done = match end? {
        End::Time => "disarmed: the duration has elapsed",
        End::Requested => "disarmed",
    };
    print_done(done, as_json)
}

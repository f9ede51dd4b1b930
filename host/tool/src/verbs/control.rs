//! `crepitus zero`, `arm`, `disarm`, `stop` and `clear-fault`.

use crate::cli::device::{ArmArguments, DeviceArguments};
use crate::failure::{Failure, print, print_json};
use crate::following::{End, Follower, follow};
use crate::keys::Keys;
use crate::line::{Line, connect, failure, manage};
use crepitus_client::{Client, Error};
use crepitus_protocol::telemetry::Block;
use serde_json::json;

/// The angle is zero here.
pub(crate) fn zero(device: &DeviceArguments, as_json: bool) -> Result<(), Failure> {
    one(device, "the angle is zero here", as_json, Client::zero)
}

/// No more torque.
pub(crate) fn disarm(device: &DeviceArguments, as_json: bool) -> Result<(), Failure> {
    one(device, "disarmed", as_json, Client::disarm)
}

/// Forgets the faults.
pub(crate) fn clear_fault(device: &DeviceArguments, as_json: bool) -> Result<(), Failure> {
    one(device, "no fault", as_json, Client::clear_fault)
}

/// No more torque, from a device of any version.
pub(crate) fn stop(device: &DeviceArguments, as_json: bool) -> Result<(), Failure> {
    manage(device)?.stop().map_err(failure)?;
    said("stopped", as_json)
}

fn one(
    device: &DeviceArguments,
    done: &str,
    as_json: bool,
    work: impl FnOnce(&mut Client<Line>) -> Result<(), Error>,
) -> Result<(), Failure> {
    work(&mut connect(device)?).map_err(failure)?;
    said(done, as_json)
}

fn said(done: &str, as_json: bool) -> Result<(), Failure> {
    if as_json {
        print_json(&json!({ "done": done }))
    } else {
        print(&format!("{done}\n"))
    }
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

/// Torque, as long as this runs.
pub(crate) fn arm(arguments: &ArmArguments, as_json: bool) -> Result<(), Failure> {
    let mut client = connect(&arguments.device)?;
    let mut holding = Holding { keys: None };
    let end = follow(&mut client, arguments.for_s, true, &mut holding);
    // The terminal first, then what is to be said.
    drop(holding);
    let done = match end? {
        End::Time => "disarmed: the time is over",
        End::Asked => "disarmed",
    };
    said(done, as_json)
}

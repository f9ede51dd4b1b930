//! Verbs that are one request to a device.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{Line, connect, failure_with};
use crepitus_client::{Client, Error};
use serde_json::json;

/// Connects, sends the request and prints `done`.
pub(crate) fn execute(
    device: &DeviceArguments,
    done: &str,
    as_json: bool,
    request: impl FnOnce(&mut Client<Line>) -> Result<(), Error>,
) -> Result<(), Failure> {
    let mut client = connect(device)?;
    request(&mut client).map_err(|error| failure_with(&mut client, error))?;
    print_done(done, as_json)
}

/// Prints what was done.
pub(crate) fn print_done(done: &str, as_json: bool) -> Result<(), Failure> {
    if as_json {
        print_json(&json!({ "done": done }))
    } else {
        print(&format!("{done}\n"))
    }
}

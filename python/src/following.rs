//! The loop that receives from a device, renews the lease of an armed one, and ends at
//! Ctrl-C.

use crate::errors;
use crate::signals::Signals;
use crepitus_client::connection::{Connection, device_text, is_input};
use crepitus_client::{Client, Error, Event};
use crepitus_protocol::telemetry::Block;
use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Timeout of a poll for events; signals are checked between polls.
const POLL_TIMEOUT: Duration = Duration::from_millis(20);

/// Converts the error of a request: values that no device accepts are a `ValueError`, all else a
/// `DeviceError`.
pub(crate) fn failure(error: Error) -> PyErr {
    let text = error.to_string();
    if is_input(&error) {
        PyValueError::new_err(text)
    } else {
        errors::device(text)
    }
}

/// Follows the device for a duration. `on_block` gets every block of a subscription; `stop` of
/// another thread ends it early. After an error an armed device is disarmed.
pub(crate) fn follow(
    client: &mut Client<Connection>,
    time: Duration,
    stop: &AtomicBool,
    mut on_block: impl FnMut(&mut Client<Connection>, &Block) -> PyResult<()>,
) -> PyResult<()> {
    let result = run(client, time, stop, &mut on_block);
    if result.is_err() && client.is_connected() && client.is_armed() {
        // The first error is the one to report.
        let _ = client.disarm();
    }
    result
}

fn run(
    client: &mut Client<Connection>,
    time: Duration,
    stop: &AtomicBool,
    on_block: &mut dyn FnMut(&mut Client<Connection>, &Block) -> PyResult<()>,
) -> PyResult<()> {
    let mut signals = Signals::new();
    let was_armed = client.is_armed();
    let end = client.now() + time;
    while client.now() < end {
        signals.check()?;
        if stop.load(Ordering::Relaxed) {
            // The thread that asked for it sends the request.
            return Ok(());
        }
        let left = end.saturating_sub(client.now());
        match client.pump(POLL_TIMEOUT.min(left)).map_err(failure)? {
            Some(Event::Block(arrival)) => on_block(client, &arrival.block)?,
            Some(Event::Lost(error)) => {
                return Err(errors::device(format!(
                    "{error}; open the device again, and arm it again if it was armed"
                )));
            }
            _ => {}
        }
        if was_armed && client.is_connected() && !client.is_armed() {
            return Err(disarmed(client));
        }
    }
    Ok(())
}

/// Returns the exception of an armed device that has disarmed by itself.
fn disarmed(client: &mut Client<Connection>) -> PyErr {
    let status = match client.status() {
        Ok(status) => status,
        Err(error) => return failure(error),
    };
    let faults = device_text::faults(&status);
    errors::device(if faults.is_empty() {
        "another program has disarmed the device".to_owned()
    } else {
        faults.join("\n")
    })
}

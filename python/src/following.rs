//! The loop that receives from a device, renews the lease of an armed one, and ends at
//! Ctrl-C.

use crate::errors;
use crate::signals::Signals;
use crate::turns::{Held, Turn};
use crepitus_client::connection::{Connection, device_text};
use crepitus_client::{Client, Event};
use crepitus_protocol::telemetry::Block;
use pyo3::PyErr;
use pyo3::prelude::*;
use std::time::Duration;

/// Timeout of a poll for events; between polls signals are checked, and other threads have their turn.
const POLL_TIMEOUT: Duration = Duration::from_millis(20);

/// Follows the device for a duration. `on_block` gets every block of a subscription, and returns whether to go on; a stop ends
/// it early. After an error an armed device is disarmed.
pub(crate) fn follow(
    turn: &Turn,
    time: Duration,
    mut on_block: impl FnMut(&mut Held, &Block) -> PyResult<bool>,
) -> PyResult<()> {
    let _followed = turn.follow();
    let result = run(turn, time, &mut on_block);
    if result.is_err() {
        // The first error is the one to report.
        let _ = turn.shared.with(|held| {
            held.expects_torque = false;
            if held.client.is_connected() && held.client.is_armed() {
                let _ = held.client.disarm();
            }
            Ok(())
        });
    }
    result
}

fn run(
    turn: &Turn,
    time: Duration,
    on_block: &mut dyn FnMut(&mut Held, &Block) -> PyResult<bool>,
) -> PyResult<()> {
    let mut signals = Signals::new();
    let end = turn.shared.with(|held| Ok(held.client.now() + time))?;
    loop {
        signals.check()?;
        if turn.is_stopped() {
            // The thread that asked for it sends the request.
            return Ok(());
        }
        if !turn.shared.with(|held| poll(held, end, on_block))? {
            return Ok(());
        }
    }
}

/// Polls once; returns whether to go on.
fn poll(
    held: &mut Held,
    end: Duration,
    on_block: &mut dyn FnMut(&mut Held, &Block) -> PyResult<bool>,
) -> PyResult<bool> {
    let left = end.saturating_sub(held.client.now());
    if left.is_zero() {
        return Ok(false);
    }
    let mut goes_on = true;
    match held
        .client
        .pump(POLL_TIMEOUT.min(left))
        .map_err(errors::failure)?
    {
        Some(Event::Block(arrival)) => {
            held.timeline.see(&arrival.block, held.client.now());
            goes_on = on_block(held, &arrival.block)?;
        }
        Some(Event::Lost(error)) => {
            return Err(errors::device(format!(
                "{error}; open the device again, and arm it again if it was armed"
            )));
        }
        _ => {}
    }
    let client = &mut held.client;
    if held.expects_torque && client.is_connected() && !client.is_armed() {
        return Err(disarmed(client));
    }
    Ok(goes_on)
}

/// Returns the exception of an armed device that has disarmed by itself.
fn disarmed(client: &mut Client<Connection>) -> PyErr {
    let status = match client.status() {
        Ok(status) => status,
        Err(error) => return errors::failure(error),
    };
    let faults = device_text::faults(&status);
    errors::device(if faults.is_empty() {
        "another program has disarmed the device".to_owned()
    } else {
        faults.join("\n")
    })
}

//! Recordings and accounting of a subscription.

use crate::errors;
use crate::following::{failure, follow};
use crepitus_client::connection::Connection;
use crepitus_client::{Accounting, Client};
use crepitus_recording::{RecordError, Recorder};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Ends a subscription; an earlier error takes precedence.
pub(crate) fn unsubscribed(client: &mut Client<Connection>, result: PyResult<()>) -> PyResult<()> {
    let ended = if client.is_connected() {
        client.unsubscribe().map_err(failure)
    } else {
        Ok(())
    };
    result.and(ended)
}

/// Records for a duration.
pub(crate) fn recorded(
    client: &mut Client<Connection>,
    recorder: &mut Recorder,
    time: Duration,
    stop: &AtomicBool,
) -> PyResult<()> {
    let begin = client.subscribe().map_err(failure)?;
    recorder.subscribed(begin).map_err(not_recorded)?;
    let mut announced = None;
    follow(client, time, stop, |client, block| {
        if announced != Some(block.revision) {
            let (revision, values) = client.parameters().map_err(failure)?;
            recorder.announce(revision, &values);
            announced = Some(block.revision);
        }
        recorder.block(block).map_err(not_recorded)?;
        recorder.flush().map_err(not_recorded)
    })
}

/// Returns the accounting of samples as JSON.
pub(crate) fn accounting_json(accounting: &Accounting) -> Value {
    json!({
        "produced": accounting.produced(),
        "received": accounting.received(),
        "dropped": accounting.dropped(),
        "by_device": accounting.dropped_by_device(),
    })
}

/// Converts an error of the recording file.
pub(crate) fn not_recorded(error: RecordError) -> PyErr {
    errors::device(error.to_string())
}

//! Recordings and accounting of a subscription.

use crate::errors;
use crate::errors::failure;
use crate::following::follow;
use crate::turns::{Held, Turn};
use crepitus_client::Accounting;
use crepitus_recording::{Metadata, RecordError, Recorder};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Ends a subscription; an earlier error takes precedence.
pub(crate) fn unsubscribed(turn: &Turn, result: PyResult<()>) -> PyResult<()> {
    let ended = turn.shared.with(|held| {
        if held.client.is_connected() {
            held.client.unsubscribe().map_err(failure)
        } else {
            Ok(())
        }
    });
    result.and(ended)
}

/// Records to a file for a duration; returns the accounting (JSON), or none if no sample came, and then there is no file.
pub(crate) fn record(
    turn: &Turn,
    file: &Path,
    title: &str,
    time: Duration,
) -> PyResult<Option<String>> {
    let mut recorder = turn.shared.with(|held| {
        let handshake = held.client.handshake();
        let metadata = Metadata::new(title, &handshake.comms, handshake.drive.as_ref());
        Recorder::create(file, &metadata).map_err(not_recorded)
    })?;
    let result = recorded(turn, &mut recorder, time);
    let result = unsubscribed(turn, result);
    if recorder.totals().received == 0 {
        drop(recorder);
        fs::remove_file(file)?;
        return result.map(|()| None);
    }
    // What was recorded is kept, also after an error.
    let totals = recorder.finish().map_err(not_recorded)?;
    result?;
    let totals = serde_json::to_string(&totals);
    totals
        .map(Some)
        .map_err(|error| errors::device(error.to_string()))
}

fn recorded(turn: &Turn, recorder: &mut Recorder, time: Duration) -> PyResult<()> {
    let begin = turn
        .shared
        .with(|held| held.client.subscribe().map_err(failure))?;
    recorder.subscribed(begin).map_err(not_recorded)?;
    let mut announced = None;
    follow(turn, time, |held, block| {
        if announced != Some(block.revision) {
            let (revision, values) = held.client.parameters().map_err(failure)?;
            recorder.announce(revision, &values);
            announced = Some(block.revision);
        }
        recorder.block(block).map_err(not_recorded)?;
        recorder.flush().map_err(not_recorded)?;
        Ok(true)
    })
}

/// Returns the accounting of the samples of a subscription as JSON.
pub(crate) fn accounting_json(held: &Held) -> String {
    let json = |accounting: &Accounting| {
        json!({
            "produced": accounting.produced(),
            "received": accounting.received(),
            "dropped": accounting.dropped(),
            "by_device": accounting.dropped_by_device(),
        })
    };
    held.client
        .accounting()
        .map_or(Value::Null, json)
        .to_string()
}

/// Converts an error of the recording file.
fn not_recorded(error: RecordError) -> PyErr {
    errors::device(error.to_string())
}

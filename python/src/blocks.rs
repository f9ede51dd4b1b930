//! Samples of a device, block by block or all at once.

use crate::errors::failure;
use crate::following::follow;
use crate::received::{accounting_json, unsubscribed};
use crate::samples::Samples;
use crate::timeline::Mark;
use crate::turns::{Held, Shared, Turn};
use crepitus_protocol::Revision;
use crepitus_protocol::TICKS_PER_S;
use crepitus_protocol::telemetry::Block;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Time that a block may take beyond its own: a device that sends nothing does not keep a loop waiting.
const MOST_DELAY: Duration = Duration::from_millis(500);

/// Samples with the accounting (JSON), the marks, and the Unix time of `t_s` = 0.
pub(crate) type Received<'py> = (Bound<'py, PyDict>, String, Vec<(f64, String)>, f64);

/// Converts blocks of the device to samples.
struct Converter {
    rows: crepitus_recording::Samples,
    revision: Option<Revision>,
    every: u64,
}

impl Converter {
    fn new(every: u64) -> Self {
        Self {
            rows: crepitus_recording::Samples::default(),
            revision: None,
            every,
        }
    }

    fn add(&mut self, held: &mut Held, block: &Block, samples: &mut Samples) -> PyResult<()> {
        if self.revision != Some(block.revision) {
            let (now, values) = held.client.parameters().map_err(failure)?;
            self.rows.set(&values);
            self.revision = Some(now);
        }
        for mut row in self.rows.rows(block) {
            if row.tick.is_multiple_of(self.every) {
                row.time_s = held.timeline.seconds(row.tick);
                samples.push(&row);
            }
        }
        Ok(())
    }
}

/// Samples and all that belongs to them, before they become Python's.
struct Part {
    samples: Samples,
    accounting: String,
    marks: Vec<Mark>,
    zero_unix_s: f64,
}

impl Part {
    fn of(held: &mut Held, samples: Samples) -> Self {
        Self {
            samples,
            accounting: accounting_json(held),
            marks: std::mem::take(&mut held.timeline.marks),
            zero_unix_s: held.timeline.zero_unix_s,
        }
    }

    fn into_py(self, py: Python<'_>) -> PyResult<Received<'_>> {
        let marks = self.marks.into_iter().map(|mark| (mark.time_s, mark.text));
        let samples = self.samples.into_dict(py)?;
        Ok((samples, self.accounting, marks.collect(), self.zero_unix_s))
    }
}

/// Streams for a duration, every n-th sample.
pub(crate) fn stream<'py>(
    py: Python<'py>,
    shared: &Arc<Shared>,
    time: Duration,
    every: u64,
) -> PyResult<Received<'py>> {
    let part = py.detach(|| {
        let turn = Turn::take(shared)?;
        let mut samples = Samples::default();
        let mut converter = Converter::new(every);
        subscribe(&turn)?;
        let result = follow(&turn, time, |held, block| {
            converter.add(held, block, &mut samples)?;
            Ok(true)
        });
        let part = turn.shared.with(|held| Ok(Part::of(held, samples)));
        unsubscribed(&turn, result)?;
        part
    })?;
    part.into_py(py)
}

fn subscribe(turn: &Turn) -> PyResult<()> {
    turn.shared
        .with(|held| held.client.subscribe().map(drop).map_err(failure))
}

/// A subscription that is received block by block.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Blocks(Mutex<Option<Open>>);

/// A subscription that has not ended.
struct Open {
    turn: Turn,
    converter: Converter,
    /// Length of a block.
    time: Duration,
    ticks: u64,
    /// Time until the end, if there is one.
    left: Option<Duration>,
}

impl Blocks {
    /// Subscribes to a device, for a duration or without end.
    pub(crate) fn begin(
        py: Python<'_>,
        shared: &Arc<Shared>,
        time: Duration,
        left: Option<Duration>,
        every: u64,
    ) -> PyResult<Self> {
        py.detach(|| {
            let turn = Turn::take(shared)?;
            subscribe(&turn)?;
            let ticks = time.as_nanos() * u128::from(TICKS_PER_S) / 1_000_000_000;
            Ok(Self(Mutex::new(Some(Open {
                turn,
                converter: Converter::new(every),
                time,
                ticks: u64::try_from(ticks).unwrap_or(u64::MAX).max(1),
                left,
            }))))
        })
    }
}

#[pymethods]
impl Blocks {
    /// Returns the next block; `None` at the end, or after a stop.
    fn next<'py>(&self, py: Python<'py>) -> PyResult<Option<Received<'py>>> {
        let part = py.detach(|| match self.0.try_lock() {
            Ok(mut open) => open.as_mut().map_or(Ok(None), Open::next),
            Err(_) => Err(PyRuntimeError::new_err(
                "another thread waits for a block of this loop: give each thread its own",
            )),
        })?;
        part.map(|part| part.into_py(py)).transpose()
    }

    /// Ends the subscription; ending it again does nothing.
    fn end(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.ended())
    }
}

impl Blocks {
    fn ended(&self) -> PyResult<()> {
        let open = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(Open { turn, .. }) = open else {
            return Ok(());
        };
        if !turn.shared.is_ours() || turn.shared.lock().is_none() {
            return Ok(());
        }
        unsubscribed(&turn, Ok(()))
    }
}

impl Drop for Blocks {
    fn drop(&mut self) {
        // The thread that has the GIL must not wait for the device.
        let _ = Python::try_attach(|py| py.detach(|| self.ended()));
    }
}

impl Open {
    fn next(&mut self) -> PyResult<Option<Part>> {
        if self.turn.is_stopped() || self.left.is_some_and(|left| left.is_zero()) {
            return Ok(None);
        }
        let time = self.left.map_or(self.time, |left| left.min(self.time));
        let begun = self.turn.shared.with(|held| Ok(held.client.now()))?;
        let mut samples = Samples::default();
        let mut until = None;
        let (converter, ticks) = (&mut self.converter, self.ticks);
        let limit = if self.left.is_some() {
            time
        } else {
            time + MOST_DELAY
        };
        follow(&self.turn, limit, |held, block| {
            converter.add(held, block, &mut samples)?;
            let until = *until.get_or_insert(block.first_tick.saturating_add(ticks));
            Ok(block.end_tick() < until)
        })?;
        self.turn.shared.with(|held| {
            let passed = held.client.now().saturating_sub(begun);
            if let Some(left) = &mut self.left {
                *left = left.saturating_sub(passed);
            }
            let is_over = self.left.is_some_and(|left| left.is_zero());
            // The last one ends with the time, which may be between two blocks of the device.
            Ok((!(is_over && samples.is_empty())).then(|| Part::of(held, samples)))
        })
    }
}

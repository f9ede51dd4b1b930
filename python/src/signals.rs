//! Ctrl-C during long work.

use pyo3::prelude::*;
use std::time::{Duration, Instant};

/// Looking for signals takes the GIL, so not more often than this.
const INTERVAL: Duration = Duration::from_millis(50);

/// Runs Python's signal handlers now and then. Python does so on its main thread only;
/// elsewhere nothing happens.
pub(crate) struct Signals {
    next: Instant,
}

impl Signals {
    pub(crate) fn new() -> Self {
        Self {
            next: Instant::now() + INTERVAL,
        }
    }

    /// Returns what a handler raised: after Ctrl-C, `KeyboardInterrupt`.
    pub(crate) fn check(&mut self) -> PyResult<()> {
        let now = Instant::now();
        if now < self.next {
            return Ok(());
        }
        // An interpreter that is shutting down has no handlers any more.
        #[expect(
            clippy::redundant_closure_for_method_calls,
            reason = "the method has one lifetime"
        )]
        let checked = Python::try_attach(|py| py.check_signals()).unwrap_or(Ok(()));
        self.next = Instant::now() + INTERVAL;
        checked
    }
}

impl crepitus_study::Watcher for Signals {
    type Error = PyErr;

    fn progress(&mut self, _: f64) -> PyResult<()> {
        self.check()
    }
}

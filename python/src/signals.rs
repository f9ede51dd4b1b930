//! Signal handling during long work, for Ctrl-C.

use pyo3::prelude::*;
use std::time::{Duration, Instant};

/// Interval of checks, each of which takes the GIL.
const INTERVAL: Duration = Duration::from_millis(50);

/// Periodic check of Python's signal handlers. Python runs them on its main thread only; elsewhere
/// nothing happens.
pub(crate) struct Signals {
    next: Instant,
}

impl Signals {
    pub(crate) fn new() -> Self {
        Self {
            next: Instant::now() + INTERVAL,
        }
    }

    /// Runs the handlers, if the interval has passed; returns the exception that one raised,
    /// `KeyboardInterrupt` after Ctrl-C.
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

//! Signal handling during long work, for Ctrl-C.

use crepitus_studies::{Cancelled, Watcher};
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

/// Cancels a study when a handler raises an exception, and keeps it.
pub(crate) struct Watch {
    signals: Signals,
    raised: Option<PyErr>,
}

impl Watch {
    pub(crate) fn new() -> Self {
        Self {
            signals: Signals::new(),
            raised: None,
        }
    }

    /// The exception that ended the study; `otherwise` if none did.
    pub(crate) fn raised_or(self, otherwise: impl FnOnce() -> PyErr) -> PyErr {
        self.raised.unwrap_or_else(otherwise)
    }
}

impl Watcher for Watch {
    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        self.signals.check().map_err(|raised| {
            self.raised = Some(raised);
            Cancelled
        })
    }
}

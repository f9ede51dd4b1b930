//! Ctrl-C as a request to stop, so that partial results can be removed.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the handler: Ctrl-C sets a flag.
pub(crate) fn listen() {
    // Without a handler Ctrl-C kills the program; only the cleanup is lost.
    let _ = ctrlc::set_handler(|| REQUESTED.store(true, Ordering::Relaxed));
}

/// Whether Ctrl-C was pressed.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

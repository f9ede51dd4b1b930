//! Ctrl-C ends the work in order: what was being written is taken away.

use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on, Ctrl-C only asks.
pub(crate) fn listen() {
    // Without a handler, Ctrl-C ends the program as ever: nothing is lost but
    // the tidying up.
    let _ = ctrlc::set_handler(|| ASKED.store(true, Ordering::Relaxed));
}

/// Whether the person at the keyboard wants an end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

//! Any key ends it: the terminal gives single keys, and is put back after.

use crossterm::event::{Event, KeyEventKind, poll, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use std::io::{IsTerminal, stdin};
use std::time::Duration;

/// Listens for keys as long as it lives.
pub(crate) struct Keys(bool);

impl Keys {
    /// On a terminal; elsewhere nothing is ever pressed.
    pub(crate) fn listen() -> Self {
        Self(stdin().is_terminal() && enable_raw_mode().is_ok())
    }

    /// Whether keys can be pressed.
    pub(crate) fn are_heard(&self) -> bool {
        self.0
    }

    /// Whether one was pressed. Ctrl-C is one.
    pub(crate) fn pressed(&self) -> bool {
        while self.0 && poll(Duration::ZERO).unwrap_or(false) {
            match read() {
                Ok(Event::Key(key)) if key.kind == KeyEventKind::Press => return true,
                // A terminal that is gone has nobody at it.
                Err(_) => return true,
                Ok(_) => {}
            }
        }
        false
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        if self.0 {
            let _ = disable_raw_mode();
        }
    }
}

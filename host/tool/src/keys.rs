//! Single key presses from the terminal, whose mode is restored on drop.

use crossterm::event::{Event, KeyEventKind, poll, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use std::io::{IsTerminal, stdin};
use std::time::Duration;

/// Key presses while this value lives.
pub(crate) struct Keys(bool);

impl Keys {
    /// Switches a terminal to raw mode; without a terminal there are no keys.
    pub(crate) fn listen() -> Self {
        Self(stdin().is_terminal() && enable_raw_mode().is_ok())
    }

    /// Whether stdin is a terminal that delivers keys.
    pub(crate) fn is_active(&self) -> bool {
        self.0
    }

    /// Whether a key was pressed, Ctrl-C included.
    pub(crate) fn pressed(&self) -> bool {
        while self.0 && poll(Duration::ZERO).unwrap_or(false) {
            match read() {
                Ok(Event::Key(key)) if key.kind == KeyEventKind::Press => return true,
                // The terminal is closed.
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

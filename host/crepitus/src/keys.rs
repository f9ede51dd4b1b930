//! Single key presses from the terminal, whose mode is restored on drop.

use crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers, poll, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use std::io::{IsTerminal, stdin};
use std::time::Duration;

/// A key press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Key {
    Enter,
    Character(char),
    /// Ctrl-C, which raises no signal in raw mode, or a terminal that was closed.
    Interrupt,
    Other,
}

/// Key presses while this value lives.
pub(crate) struct Keys(bool);

impl Keys {
    /// Switches a terminal to raw mode; without a terminal there are no keys.
    pub(crate) fn listen() -> Self {
        Self(stdin().is_terminal() && enable_raw_mode().is_ok())
    }

    /// Returns whether stdin is a terminal that delivers keys.
    pub(crate) fn is_active(&self) -> bool {
        self.0
    }

    /// Returns whether a key was pressed, Ctrl-C included.
    pub(crate) fn pressed(&self) -> bool {
        self.next().is_some()
    }

    /// The next key press, without waiting for one.
    pub(crate) fn next(&self) -> Option<Key> {
        while self.0 && poll(Duration::ZERO).unwrap_or(false) {
            match read() {
                Ok(Event::Key(key)) if key.kind == KeyEventKind::Press => {
                    let with_control = key.modifiers.contains(KeyModifiers::CONTROL);
                    return Some(match key.code {
                        KeyCode::Char('c') if with_control => Key::Interrupt,
                        KeyCode::Char(character) => Key::Character(character),
                        KeyCode::Enter => Key::Enter,
                        _ => Key::Other,
                    });
                }
                // The terminal is closed.
                Err(_) => return Some(Key::Interrupt),
                Ok(_) => {}
            }
        }
        None
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        if self.0 {
            let _ = disable_raw_mode();
        }
    }
}

//! The terminal as a screen, restored on drop.

use ratatui::{DefaultTerminal, Frame};
use std::io;

/// The terminal's other screen, in raw mode.
pub(super) struct Screen(DefaultTerminal);

impl Screen {
    /// Takes the terminal. A panic restores it, too.
    ///
    /// # Errors
    /// It cannot be used.
    pub(super) fn take() -> io::Result<Self> {
        ratatui::try_init().map(Self)
    }

    /// Draws a picture.
    ///
    /// # Errors
    /// The terminal is gone.
    pub(super) fn draw(&mut self, draw: impl FnOnce(&mut Frame<'_>)) -> io::Result<()> {
        self.0.draw(draw).map(|_| ())
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Not `restore`, which would print that the terminal is gone, to it.
        let _ = ratatui::try_restore();
    }
}

//! The terminal as a screen, restored on drop.

use ratatui::{DefaultTerminal, Frame};
use std::io;
use std::mem::ManuallyDrop;

/// The terminal's other screen, in raw mode. Its own drop, and `ratatui::restore`, would print that
/// the terminal is gone, to it, which panics.
pub(super) struct Screen(ManuallyDrop<DefaultTerminal>);

impl Screen {
    /// Takes the terminal. A panic restores it, too.
    ///
    /// # Errors
    /// The terminal cannot be used.
    pub(super) fn take() -> io::Result<Self> {
        ratatui::try_init().map(ManuallyDrop::new).map(Self)
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
        let _ = self.0.show_cursor();
        let _ = ratatui::try_restore();
    }
}

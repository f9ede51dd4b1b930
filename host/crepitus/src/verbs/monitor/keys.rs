//! The monitor's keys.

use crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers, poll, read};
use std::time::Duration;

/// Command of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    /// Torque off at once, regardless of which program has armed.
    Stop,
    /// Disarm.
    Disarm,
    /// Set a mark.
    Mark,
    /// Choose the next target.
    NextTarget,
    /// Begin or end a score.
    Score,
    /// Quit.
    Quit,
}

/// Keys of a terminal that is a screen.
pub(super) struct Keys;

impl Keys {
    /// The next key that means something.
    #[expect(clippy::unused_self, reason = "the keys of this screen")]
    pub(super) fn next(&self) -> Option<Key> {
        while poll(Duration::ZERO).unwrap_or(false) {
            match read() {
                Ok(Event::Key(key)) if key.kind == KeyEventKind::Press => {
                    let control = key.modifiers.contains(KeyModifiers::CONTROL);
                    if let Some(key) = meaning(key.code, control) {
                        return Some(key);
                    }
                }
                // The terminal is closed.
                Err(_) => return Some(Key::Quit),
                Ok(_) => {}
            }
        }
        None
    }
}

fn meaning(code: KeyCode, control: bool) -> Option<Key> {
    match (code, control) {
        (KeyCode::Char('c'), true) | (KeyCode::Char('q' | 'Q'), false) => Some(Key::Quit),
        (KeyCode::Esc, _) | (KeyCode::Char('s' | 'S' | ' '), false) => Some(Key::Stop),
        (KeyCode::Char('d' | 'D'), false) => Some(Key::Disarm),
        (KeyCode::Char('m' | 'M'), false) => Some(Key::Mark),
        (KeyCode::Char('t' | 'T'), false) => Some(Key::NextTarget),
        (KeyCode::Char('r' | 'R'), false) => Some(Key::Score),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_mean_what_the_help_says() {
        for (code, control, expected) in [
            (KeyCode::Esc, false, Some(Key::Stop)),
            (KeyCode::Char('s'), false, Some(Key::Stop)),
            (KeyCode::Char('d'), false, Some(Key::Disarm)),
            (KeyCode::Char('m'), false, Some(Key::Mark)),
            (KeyCode::Char('t'), false, Some(Key::NextTarget)),
            (KeyCode::Char('r'), false, Some(Key::Score)),
            (KeyCode::Char('q'), false, Some(Key::Quit)),
            (KeyCode::Char('c'), true, Some(Key::Quit)),
            (KeyCode::Char('c'), false, None),
            (KeyCode::Enter, false, None),
        ] {
            assert_eq!(meaning(code, control), expected, "{code:?}");
        }
    }
}

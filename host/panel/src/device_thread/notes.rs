//! Notes on the time line.

use super::DeviceThread;
use crate::shared::Outcome;
use axum::extract::ws::Utf8Bytes;
use crepitus_client::Transport;
use serde_json::json;

/// Most characters of a note.
const MOST_NOTE: usize = 500;

/// Most notes that are kept.
const MOST_NOTES: usize = 1_000;

/// A note on the time line.
pub(super) struct Note {
    time_s: f64,
    text: String,
    by: &'static str,
}

impl<T: Transport> DeviceThread<'_, T> {
    pub(super) fn add_note(&mut self, text: &str) -> Outcome {
        let text = text.trim();
        let count = text.chars().count();
        if !(1..=MOST_NOTE).contains(&count) {
            return Err(format!(
                "a note has 1 to {MOST_NOTE} characters, got {count}"
            ));
        }
        self.note_in_lesson(text)?;
        self.push_note(text, "teacher");
        Ok(json!({ "time_s": self.now_s }))
    }

    pub(super) fn push_note(&mut self, text: &str, by: &'static str) {
        if self.notes.len() >= MOST_NOTES {
            return;
        }
        let note = Note {
            time_s: self.now_s,
            text: text.to_owned(),
            by,
        };
        let message =
            json!({ "note": { "time_s": note.time_s, "text": note.text, "by": note.by } });
        self.notes.push(note);
        let message = Utf8Bytes::from(message.to_string());
        (self.shared.latest).send_modify(|latest| latest.notes.push(message));
    }
}

//! A lesson that goes on after its program was interrupted, from its folder.

use super::DeviceThread;
use super::lessons::Held;
use crate::lesson::{HEALTHY, SessionFolder};
use crate::shared::Outcome;
use crepitus_client::Transport;
use serde_json::Value;
use std::path::{Component, Path};

impl<T: Transport> DeviceThread<'_, T> {
    /// Continues the lesson in this folder of the sessions' folder.
    pub(super) fn resume_lesson(&mut self, name: &str) -> Outcome {
        self.check_no_lesson()?;
        let parent = self.sessions.as_ref();
        let parent = parent.ok_or("this panel stores nothing, so there is nothing to continue")?;
        if !is_plain(name) {
            return Err(format!("there is no lesson {name:?}: reload the page"));
        }
        let opened = SessionFolder::open(&parent.join(name));
        let (folder, mut session) = opened.map_err(|error| error.to_string())?;
        if session.lesson.ended() {
            return Err("the lesson has ended: begin another one".to_owned());
        }
        // The device may still have the knee of the trial that was interrupted.
        self.apply_unseen(HEALTHY)?;
        session.lesson.take_up();
        self.end_recording();
        let keys = folder.keys();
        self.class.restore(&keys);
        self.lesson = Some(Held::resumed(session, folder, keys, self.now_s));
        self.store_keys();
        self.publish_parameters();
        self.changed();
        self.publish_class();
        Ok(Value::Null)
    }
}

/// Returns whether a name is that of an entry of a folder, and of nothing else.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    let first = parts.next();
    matches!(first, Some(Component::Normal(part)) if part == name) && parts.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_named_and_no_path() {
        assert!(is_plain("2026-11-24-154205-blind-six"));
        for path in ["", ".", "..", "/etc", "a/b", "../a", "a/..", "./a", "a/"] {
            assert!(!is_plain(path), "{path}");
        }
    }
}

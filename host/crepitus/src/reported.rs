//! Result of a run or of a recording's report, as `run`, `report` and `demo` print it.

use crate::overlay;
use crate::wav;
use crepitus_files::json_path;
use crepitus_pages::report::Difference;
use crepitus_pages::sound::SoundSummary;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// The summary, with the results of `--overlay` and `--wav`.
pub(crate) struct Reported<S> {
    pub(crate) summary: S,
    /// Empty without `--overlay`.
    pub(crate) differences: Vec<Difference>,
    /// None without `--wav`.
    pub(crate) sound: Option<SoundSummary>,
}

impl<S: Serialize> Reported<S> {
    /// The JSON of `--json`. `overlay` and `sound` are there only where the option was given.
    pub(crate) fn json(&self, out: &Path) -> Value {
        let mut printed = json!({ "out": json_path(out), "summary": self.summary });
        if let Some(sound) = &self.sound {
            printed["sound"] = json!(sound);
        }
        if !self.differences.is_empty() {
            printed["overlay"] = json!(self.differences);
        }
        printed
    }

    /// The text for people: the summary in brief, a line per measured curve and sound, the main file.
    pub(crate) fn text(&self, brief: &str, what: &str, file: &Path) -> String {
        format!(
            "{brief}{}{}{what}: {}\n",
            overlay::in_brief(&self.differences),
            wav::in_brief(self.sound.as_ref()),
            file.display()
        )
    }
}

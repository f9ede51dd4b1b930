//! Outcome of a row.

use super::rows::Row;
use serde_json::{Value as Json, json};

/// Verdict on a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// As expected, measured or seen.
    Good,
    /// Not as expected.
    Bad,
    /// The row could not tell.
    Unknown,
    /// Left out.
    Skipped,
    /// For a person to see, and nobody was there.
    ByHand,
}

impl Verdict {
    /// Name of the verdict, for people and files.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Bad => "bad",
            Self::Unknown => "unknown",
            Self::Skipped => "skipped",
            Self::ByHand => "by hand",
        }
    }
}

/// Outcome of a row.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) row: &'static Row,
    pub(super) verdict: Verdict,
    /// Finding.
    pub(super) found: String,
    /// Remedy if it is not good.
    pub(super) remedy: &'static str,
}

impl Outcome {
    /// As expected.
    pub(super) fn good(row: &'static Row, found: impl Into<String>) -> Self {
        Self::new(row, Verdict::Good, found, "")
    }

    /// Not as expected.
    pub(super) fn bad(row: &'static Row, found: impl Into<String>, remedy: &'static str) -> Self {
        Self::new(row, Verdict::Bad, found, remedy)
    }

    /// Outcome of any verdict.
    pub(super) fn new(
        row: &'static Row,
        verdict: Verdict,
        found: impl Into<String>,
        remedy: &'static str,
    ) -> Self {
        Self {
            row,
            verdict,
            found: found.into(),
            remedy,
        }
    }

    /// Returns whether the bring-up must not go on with it.
    pub(super) fn is_wrong(&self) -> bool {
        matches!(self.verdict, Verdict::Bad | Verdict::Unknown)
    }

    /// Text for people.
    pub(super) fn text(&self) -> String {
        let Self { row, verdict, .. } = self;
        let mut text = format!("{:>3} {:<12} {}", row.number, row.name, verdict.name());
        if !self.found.is_empty() {
            text.extend([": ", self.found.as_str()]);
        }
        if !self.remedy.is_empty() {
            text.extend(["\n      to do: ", self.remedy]);
        }
        text + "\n"
    }

    /// JSON for programs.
    pub(super) fn json(&self) -> Json {
        json!({
            "row": self.row.number,
            "name": self.row.name,
            "measured": self.row.check.name(),
            "result": self.verdict.name(),
            "found": self.found,
            "remedy": self.remedy,
        })
    }
}

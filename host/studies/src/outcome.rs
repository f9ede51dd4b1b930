//! The form of a study: what its verb prints, what its page shows, and its files.
//!
//! ```text
//! plan ─> run ─> Outcome ─┬─> answer, then as much of a table as a screen holds, or all of it
//!                         ├─> report.html, figures
//!                         └─> summary.json, tables
//! ```
//!
//! A study is a folder with its engine, its tables, its page (`report`) and its words (`words`, which
//! implements this trait). Its verb makes the plan from the command line.

use crate::Picture;
use crepitus_pages::plot::Paper;
use serde::Serialize;

/// Findings of a study.
pub trait Outcome {
    /// Added by `--all`, as the last line of the screen names it: `every case`.
    const REST: &'static str;

    /// Key of the summary in what `--json` prints.
    const JSON_KEY: &'static str = "summary";

    /// Numbers of `summary.json`.
    fn summary(&self) -> impl Serialize;

    /// The page, complete in itself.
    fn page(&self) -> String;

    /// Figures of the page, for files of their own.
    fn pictures(&self, paper: Paper) -> Vec<Picture>;

    /// Names and contents of the files beside page and summary.
    fn tables(&self) -> Vec<(&'static str, String)>;

    /// The answer in a few sentences.
    fn answer(&self) -> String;

    /// Table below the answer, of which a screen shows what it holds.
    fn in_short(&self) -> String;

    /// Everything below the answer.
    fn in_full(&self) -> String;

    /// Warnings, a sentence each.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Everything that must hold and does not: the verb then fails.
    fn broken(&self) -> Option<String> {
        None
    }
}

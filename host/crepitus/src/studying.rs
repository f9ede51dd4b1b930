//! Common parts of the verbs that carry out a study: the progress that they show, how they are
//! interrupted, their files, and what they print.

use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::pictures::Pictures;
use crate::progress::Progress;
use crate::results::{self, REPORT, report_files};
use crate::screen::{All, screen};
use crepitus_files::json_path;
use crepitus_files::output::{Claim, Folder};
use crepitus_scene::instructions;
use crepitus_studies::{Cancelled, Outcome, StudyError, Watcher};
use serde_json::json;
use std::path::Path;

/// Moves the progress bar, and stops at Ctrl-C.
pub(crate) struct Watch(Progress);

impl Watch {
    pub(crate) fn new() -> Self {
        interrupt::listen();
        Self(Progress::of_study())
    }
}

impl Watcher for Watch {
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
        self.0.reached(fraction);
        if interrupt::requested() {
            return Err(Cancelled);
        }
        Ok(())
    }
}

/// Instructions of a step of so many scenes, which this program runs again with the same arguments,
/// for so many steps; `None` without valgrind.
pub(crate) fn counted(scenes_and_steps: (usize, u32)) -> Option<Vec<f64>> {
    if !instructions::can_count() {
        return None;
    }
    let program = std::env::current_exe().ok()?;
    let arguments = std::env::args_os().skip(1);
    match instructions::per_step(&program, arguments, scenes_and_steps) {
        Ok(counts) => Some(counts),
        Err(error) => {
            warn(format!("instructions were not counted: {error}"));
            None
        }
    }
}

/// The failure of a study.
pub(crate) fn failed(error: StudyError) -> Failure {
    match error {
        StudyError::Cancelled(_) => Failure::interrupted(),
        other => Failure::Work(format!("the study failed: {other}")),
    }
}

/// The folder of a study's results, not yet in place: page, summary, and these tables. Called before the
/// work, so that what is in the way ends it early.
pub(crate) fn folder(out: &Path, claim: Claim, tables: &[&str]) -> Result<Folder, Failure> {
    results::folder(out, claim, REPORT.iter().chain(tables))
}

/// Writes the files of a study, and moves their folder into place.
pub(crate) fn write(
    outcome: &impl Outcome,
    (folder, out): (Folder, &Path),
    pictures: &Pictures,
) -> Result<(), Failure> {
    let pictures = pictures.files(|paper| outcome.pictures(paper))?;
    let mut files = report_files(outcome.page(), &outcome.summary(), pictures)?;
    let tables = outcome.tables().into_iter();
    files.extend(tables.map(|(name, content)| (name.to_owned(), content.into())));
    results::write(folder, out, files)
}

/// Prints a study, and fails if what must hold does not.
pub(crate) fn show<O: Outcome>(
    outcome: &O,
    out: &Path,
    all: All,
    as_json: bool,
) -> Result<(), Failure> {
    let broken = outcome.broken();
    if as_json {
        print_json(&json!({ "out": json_path(out), (O::JSON_KEY): outcome.summary() }))?;
        // The summary has what is broken.
        return broken.map_or(Ok(()), |_| Err(Failure::Negative));
    }
    for warning in outcome.warnings() {
        warn(warning);
    }
    let (answer, report) = (outcome.answer(), out.join("report.html"));
    let report = report.display();
    print(&if all.all {
        format!("{answer}\n\n{}\nreport: {report}\n", outcome.in_full())
    } else {
        let last = format!("report: {report}; --all prints {}", O::REST);
        screen(&answer, &outcome.in_short(), &last)
    })?;
    broken.map_or(Ok(()), |what| Err(Failure::Work(what)))
}

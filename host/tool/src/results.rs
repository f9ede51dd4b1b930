//! The files that a run, a study or a recording's report leaves.

use crate::failure::Failure;
use crepitus_plot::{Figure, pictures};
use crepitus_scene::output::Folder;
use serde::Serialize;
use serde_json::Value;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Names and contents of files.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// The folder of the results, not yet in place. Called before the work, so
/// that a folder without write permission fails early.
///
/// One that holds a run, which could not be repeated without its summary, is refused.
pub(crate) fn folder(out: &Path) -> Result<Folder, Failure> {
    if summary_in(out)["scene_as_run"].is_string() {
        return Err(Failure::Input(format!(
            "{} holds a run, whose summary.json would be replaced: name another folder with --out",
            out.display()
        )));
    }
    folder_of_run(out)
}

/// The same for a run.
pub(crate) fn folder_of_run(out: &Path) -> Result<Folder, Failure> {
    Folder::create(out).map_err(|e| Failure::at(out, "cannot be written", &e))
}

/// The summary that a folder has; null if there is none.
fn summary_in(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("summary.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// `report.html` and `summary.json`, and the pictures.
pub(crate) fn report_files(
    page: String,
    summary: &impl Serialize,
    pictures: Files,
) -> Result<Files, Failure> {
    let mut files = vec![
        ("report.html".to_owned(), page.into()),
        summary_file(summary)?,
    ];
    files.extend(pictures);
    Ok(files)
}

/// `summary.json`.
pub(crate) fn summary_file(summary: &impl Serialize) -> Result<(String, Vec<u8>), Failure> {
    json_file("summary.json", summary)
}

/// A JSON file of this name.
pub(crate) fn json_file(name: &str, value: &impl Serialize) -> Result<(String, Vec<u8>), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::Work(format!("{name} cannot be written: {e}")))?;
    Ok((name.to_owned(), (text + "\n").into()))
}

/// The charts of figures as SVG files.
pub(crate) fn svg_files<'f>(figures: impl IntoIterator<Item = &'f Figure>) -> Files {
    let files = pictures(figures).into_iter();
    files
        .map(|picture| (format!("{}.svg", picture.name), picture.svg.into()))
        .collect()
}

/// This folder, or the first of `folder-2`, `folder-3`, … that holds no other
/// run than that of `as_run`.
pub(crate) fn free_folder(wanted: &Path, as_run: &str) -> Result<PathBuf, Failure> {
    /// More than anybody keeps.
    const MOST: u32 = 10_000;
    (1..=MOST)
        .map(|number| {
            if number == 1 {
                return wanted.to_owned();
            }
            let mut name = wanted.as_os_str().to_owned();
            name.push(format!("-{number}"));
            PathBuf::from(name)
        })
        .find(|folder| !holds_another(folder, as_run))
        .ok_or_else(|| {
            Failure::Input(format!(
                "{} and {MOST} more hold other runs: name another folder with --out",
                wanted.display()
            ))
        })
}

/// Whether a folder holds another run.
fn holds_another(folder: &Path, as_run: &str) -> bool {
    if !folder.join("summary.json").exists() {
        return false;
    }
    let summary = summary_in(folder);
    let version = summary["crepitus_version"].as_str();
    summary["scene_as_run"].as_str() != Some(as_run) || version != Some(env!("CARGO_PKG_VERSION"))
}

/// Removes what an earlier run in the folder has left and this one does not
/// replace.
pub(crate) fn remove_others(folder: &Path) -> Result<(), Failure> {
    for name in ["trace.csv", "report.html"] {
        match fs::remove_file(folder.join(name)) {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                return Err(Failure::at(folder, "removing an earlier run", &e));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Writes files into a folder, and moves it into place.
pub(crate) fn write(folder: Folder, out: &Path, files: Files) -> Result<(), Failure> {
    for (name, content) in files {
        folder
            .file(&name)
            .and_then(|mut file| {
                file.write_all(&content)?;
                Folder::finish(file)
            })
            .map_err(|e| Failure::at(out, "writing the results", &e))?;
    }
    folder
        .commit()
        .map_err(|e| Failure::at(out, "moving the results into place", &e))
}

/// The last line of every report.
pub(crate) fn footer() -> String {
    format!(
        "crepitus {} · research and education prototype, not a medical device",
        env!("CARGO_PKG_VERSION")
    )
}

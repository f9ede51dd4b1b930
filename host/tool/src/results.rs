//! The files that a run, a study or a recording's report leaves.

use crate::failure::Failure;
use crepitus_scene::output::Folder;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// Names and contents of files.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// The folder of the results, not yet in place. Called before the work, so
/// that a folder without write permission fails early.
pub(crate) fn folder(out: &Path) -> Result<Folder, Failure> {
    Folder::create(out).map_err(|e| Failure::at(out, "cannot be written", &e))
}

/// `report.html` and `summary.json`, and the pictures.
pub(crate) fn report_files(
    page: String,
    summary: &impl Serialize,
    pictures: Files,
) -> Result<Files, Failure> {
    let summary = serde_json::to_string_pretty(summary)
        .map_err(|e| Failure::Work(format!("the summary cannot be written: {e}")))?;
    let mut files = vec![
        ("report.html".to_owned(), page.into()),
        ("summary.json".to_owned(), (summary + "\n").into()),
    ];
    files.extend(pictures);
    Ok(files)
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

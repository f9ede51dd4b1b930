//! The files of an identification.

use crate::failure::Failure;
use crate::results::{footer, json_file, svg_files, write as write_files};
use crepitus_identify::brace::{Brace, chart, page, scene};
use crepitus_recording::new_file;
use crepitus_scene::output::Folder;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// The page.
pub(super) const PAGE: &str = "report.html";

/// Writes page, picture and values.
pub(super) fn write(
    out: &Path,
    folder: Folder,
    brace: &Brace,
    summary: &Value,
) -> Result<(), Failure> {
    let html = page::html(brace, "The brace by a swinging weight", &footer());
    let mut files = vec![
        (PAGE.to_owned(), html.into()),
        json_file("identified.json", summary)?,
    ];
    files.extend(svg_files([&chart::figure(brace)]));
    write_files(folder, out, files)
}

/// Rejects a file that exists.
pub(super) fn is_free(file: &Path) -> Result<(), Failure> {
    if file.exists() {
        return Err(Failure::Input(format!(
            "{} already exists: choose another name with --scene-out, or remove it",
            file.display()
        )));
    }
    Ok(())
}

/// Writes the tables of a scene, whole or not at all.
pub(super) fn write_scene(file: &Path, brace: &Brace) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::at(file, "cannot be written", &error);
    let mut new = new_file(file).map_err(failed)?;
    new.write_all(scene::tables(brace).as_bytes())
        .map_err(failed)?;
    new.persist_noclobber(file)
        .map_err(|error| failed(error.error))?;
    Ok(())
}

//! The files of an identification.

use super::{chart, page};
use crate::failure::Failure;
use crate::results::{json_file, svg_files, write as write_files};
use crepitus_files::output::{Folder, NewFile};
use crepitus_identify::brace::{Brace, scene};
use crepitus_pages::words::footer;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// The page.
pub(super) const PAGE: &str = "report.html";

/// The values.
const VALUES: &str = "identified.json";

/// Names of all files.
pub(super) const NAMES: [&str; 3] = [PAGE, VALUES, "residual.svg"];

/// Writes page, picture and values.
pub(super) fn write(
    out: &Path,
    folder: Folder,
    brace: &Brace,
    summary: &Value,
) -> Result<(), Failure> {
    let html = page::html(brace, "The brace by a swinging weight", &footer());
    let mut files = vec![(PAGE.to_owned(), html.into()), json_file(VALUES, summary)?];
    files.extend(svg_files([&chart::figure(brace)]));
    write_files(folder, out, files)
}

/// Writes the tables of a scene, whole or not at all.
pub(super) fn write_scene(file: NewFile, brace: &Brace) -> Result<(), Failure> {
    let written = file.as_file().write_all(scene::tables(brace).as_bytes());
    written.map_err(|e| Failure::Work(format!("--scene-out: cannot be written: {e}")))?;
    Ok(file.persist()?)
}

//! Results of a calibration: a table, JSON and files.

use super::change::Change;
use super::finding::Finding;
use super::page;
use crate::failure::Failure;
use crate::results::{json_file, svg_files, write as write_files};
use crepitus_client::values::{full_name, show_value};
use crepitus_files::output::Folder;
use crepitus_pages::table::Table;
use crepitus_pages::words::footer;
use serde_json::{Value as Json, json};
use std::fmt::Write;
use std::path::Path;

/// The page.
pub(super) const PAGE: &str = "report.html";

/// The values.
const VALUES: &str = "calibration.json";

/// Names of all files.
pub(super) const NAMES: [&str; 3] = [PAGE, VALUES, "currents.svg"];

/// The summary for people.
pub(super) fn text(findings: &[Finding], changes: &[Change]) -> String {
    let mut text = "\n".to_owned();
    text.push_str(
        &Table::of(findings)
            .people("step", Finding::name)
            .people("result", |finding| finding.verdict.name())
            .people("found", |finding| {
                finding.values.first().map_or(String::new(), |value| {
                    format!("{} {}", value.name, value.text())
                })
            })
            .to_text(),
    );
    for change in changes {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{}={}",
            full_name(change.parameter),
            show_value(change.parameter, change.value)
        );
    }
    text
}

/// Returns findings, changes and revision as JSON.
pub(super) fn summary(findings: &[Finding], changes: &[Change], revision: Option<u32>) -> Json {
    let steps: Vec<Json> = findings
        .iter()
        .map(|finding| {
            let values: Vec<Json> = (finding.values.iter())
                .map(|v| json!({ "name": v.name, "value": v.value, "half_width": v.half_width, "unit": v.unit }))
                .collect();
            json!({
                "step": finding.name(),
                "result": finding.verdict.name(),
                "values": values,
                "remarks": finding.remarks,
                "remedy": finding.remedy,
            })
        })
        .collect();
    let parameters: Vec<Json> = changes
        .iter()
        .map(|change| json!({ "name": full_name(change.parameter), "value": change.value }))
        .collect();
    json!({
        "crepitus_version": env!("CARGO_PKG_VERSION"),
        "steps": steps,
        "parameters": parameters,
        "revision": revision,
    })
}

/// Writes page, JSON and pictures.
pub(super) fn write(
    out: &Path,
    folder: Folder,
    findings: &[Finding],
    changes: &[Change],
    summary: &Json,
) -> Result<(), Failure> {
    let figure = page::figure(findings);
    let mut files = vec![
        (
            PAGE.to_owned(),
            page::html(findings, changes, figure.as_ref(), &footer()).into(),
        ),
        json_file(VALUES, summary)?,
    ];
    files.extend(svg_files(&figure));
    write_files(folder, out, files)
}

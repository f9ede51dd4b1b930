//! The record of a bring-up: a page and a JSON file.

use super::outcome::{Outcome, Verdict};
use crate::failure::Failure;
use crate::results::{json_file, write as write_files};
use crepitus_files::output::Folder;
use crepitus_pages::plot::page::{Section, document, footer, tables, warnings};
use crepitus_pages::words::footer as last_line;
use maud::html;
use serde_json::{Value as Json, json};
use std::path::Path;

/// The page.
pub(super) const PAGE: &str = "report.html";

/// The outcomes.
const VALUES: &str = "bring-up.json";

/// Names of all files.
pub(super) const NAMES: [&str; 2] = [PAGE, VALUES];

/// Rows, device, and the first row that is wrong.
pub(super) fn summary(device: &str, outcomes: &[Outcome]) -> Json {
    let rows: Vec<Json> = outcomes.iter().map(Outcome::json).collect();
    let wrong = outcomes.iter().find(|outcome| outcome.is_wrong());
    json!({
        "crepitus_version": env!("CARGO_PKG_VERSION"),
        "device": device,
        "rows": rows,
        "first_wrong": wrong.map(|outcome| outcome.row.name),
    })
}

/// The last line for people.
pub(super) fn last(outcomes: &[Outcome]) -> String {
    let count = |verdict| {
        let of = outcomes.iter().filter(|outcome| outcome.verdict == verdict);
        of.count()
    };
    let wrong = outcomes.iter().find(|outcome| outcome.is_wrong());
    let wrong = wrong.map_or(String::new(), |outcome| {
        format!(
            "; first wrong: row {}, {}",
            outcome.row.number, outcome.row.name
        )
    });
    let by_hand = count(Verdict::ByHand);
    format!(
        "{} good, {} bad, {} unknown, {} skipped, {by_hand} for a person to see{wrong}\n",
        count(Verdict::Good),
        count(Verdict::Bad),
        count(Verdict::Unknown),
        count(Verdict::Skipped),
    )
}

/// Writes the files, and moves their folder into place.
pub(super) fn write(
    out: &Path,
    folder: Folder,
    outcomes: &[Outcome],
    summary: &Json,
) -> Result<(), Failure> {
    let wrong: Vec<String> = outcomes
        .iter()
        .filter(|outcome| outcome.is_wrong())
        .map(|outcome| outcome.text().trim().to_owned())
        .collect();
    let sections: Vec<Section> = outcomes
        .iter()
        .map(|outcome| Section {
            title: format!("{} {}", outcome.row.number, outcome.row.name),
            rows: [
                ("result", outcome.verdict.name().to_owned()),
                ("found", outcome.found.clone()),
            ]
            .map(|(name, value)| (name.to_owned(), value))
            .into(),
        })
        .collect();
    let body = html! {
        header {
            p.kicker { "Crepitus · bring-up" }
            h1 { "Bring-up of a device" }
            p.description { (summary["device"].as_str().unwrap_or_default()) }
        }
        main {
            (warnings("Rows that are not good", &wrong))
            (tables(&sections))
        }
        (footer(&last_line()))
    };
    let page = document("Bring-up of a device", "", &[], &body);
    let files = vec![(PAGE.to_owned(), page.into()), json_file(VALUES, summary)?];
    write_files(folder, out, files)
}

//! The matrix on a terminal: a line a case, and what must hold and does not.

use super::summary::{CaseSummary, Summary};
use crate::stability::Matrix;
use crepitus_pages::table::Table;
use std::fmt::Write;

/// A line a case.
pub(super) fn table(matrix: &Matrix, summary: &Summary<'_>) -> String {
    let mut text = Table::of(&summary.cases)
        .people("", |case| case.case)
        .people("case", |case| case.title)
        .people("hold", |case| case.counts.holds)
        .people("degrade", |case| case.counts.degrades)
        .people("fail", |case| case.counts.fails)
        .people("narrowest of the cells that must hold", narrowest)
        .to_text();
    // Writing to a String cannot fail.
    let counts = &summary.counts;
    let _ = writeln!(
        text,
        "\n{} cases, {} cells in {:.1} s: {} hold, {} degrade, {} fail; of the {} that must hold {}.",
        matrix.rows.len(),
        summary.cells,
        summary.wall_s,
        counts.holds,
        counts.degrades,
        counts.fails,
        counts.must_hold,
        if counts.broken == 0 {
            "all do".to_owned()
        } else {
            format!("{} do not", counts.broken)
        }
    );
    text
}

fn narrowest(case: &CaseSummary<'_>) -> String {
    let held = case.narrowest.map(|(_, cell)| {
        let verdict = cell.verdict.to_string();
        let margin = verdict.trim_start_matches("holds ");
        let margin = margin.trim_start_matches('(').trim_end_matches(')');
        format!("{margin}: {}", cell.subject)
    });
    match (case.counts.broken, held) {
        (0, Some(held)) => held,
        (0, None) if case.counts.must_hold == 0 => "none must hold".to_owned(),
        (0, None) => "met, without a number".to_owned(),
        (n, _) => format!("{n} of {} BROKEN", case.counts.must_hold),
    }
}

/// The cells that must hold and do not, spelled out; nothing if there are
/// none.
pub(super) fn broken(matrix: &Matrix) -> String {
    let mut text = String::new();
    for (case, cell) in matrix.broken() {
        if text.is_empty() {
            text.push_str("\nMust hold and does not:\n");
        }
        let _ = writeln!(
            text,
            "  {} {}, {}: {}\n      {}",
            case.id, case.name, cell.subject, cell.verdict, cell.detail
        );
    }
    text
}

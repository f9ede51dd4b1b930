//! The matrix on a terminal: a line a case, and what must hold and does not.

use super::summary::{CaseSummary, Summary};
use crepitus_study::stability::{Matrix, Subject};
use std::fmt::Write;

/// `exact-events, frozen, f32`.
pub(super) fn subject(subject: Subject) -> String {
    format!(
        "{}, {}, {}",
        subject.solver.name(),
        subject.convention.name(),
        subject.precision.name()
    )
}

/// A line a case.
pub(super) fn table(matrix: &Matrix, summary: &Summary) -> String {
    let titles = summary.cases.iter().map(|case| case.title.chars().count());
    let width = titles.max().unwrap_or(0);
    let mut text = format!(
        "{:5} {:width$} {:>5} {:>7} {:>5}  narrowest of the cells that must hold\n",
        "", "case", "hold", "degrade", "fail"
    );
    for case in &summary.cases {
        let counts = &case.counts;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:5} {:width$} {:>5} {:>7} {:>5}  {}",
            case.case,
            case.title,
            counts.holds,
            counts.degrades,
            counts.fails,
            narrowest(case)
        );
    }
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

fn narrowest(case: &CaseSummary) -> String {
    let held = case.narrowest.as_ref().map(|cell| {
        let margin = cell.verdict.trim_start_matches("holds ");
        let margin = margin.trim_start_matches('(').trim_end_matches(')');
        format!("{margin}: {}", cell.subject)
    });
    match (case.counts.broken, held) {
        (0, Some(held)) => held,
        (0, None) => "none must hold".to_owned(),
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
            case.id,
            case.name,
            subject(cell.subject),
            cell.verdict,
            cell.detail
        );
    }
    text
}

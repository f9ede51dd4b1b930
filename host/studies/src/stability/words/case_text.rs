//! All about one case, on a terminal.

use crate::stability::Row;
use crepitus_pages::words::{WIDTH, wrapped};
use std::fmt::Write;

/// Indentation of the text, columns.
const INDENT: usize = 16;

/// The case in words, then all its cells, each with the trial and the
/// criterion that its verdict is about.
pub(super) fn case(row: &Row) -> String {
    let case = &row.case;
    let mut text = format!("{} {}: {}\n\n", case.id, case.name, case.title);
    entry(&mut text, "why it is hard", &[case.hard.to_owned()]);
    entry(&mut text, "input", &case.inputs());
    entry(&mut text, "criterion", &case.criteria());
    entry(&mut text, "source", &[case.source.to_owned()]);
    let mut notes: Vec<&str> = Vec::new();
    let mut convention = "";
    for cell in &row.cells {
        let subject = cell.subject;
        // Writing to a String cannot fail.
        if subject.convention.name() != convention {
            convention = subject.convention.name();
            let _ = write!(text, "\n{convention}:\n");
        }
        let _ = writeln!(
            text,
            "  {:20} {} {:4}  {}{}",
            subject.solver.name(),
            subject.precision.name(),
            if cell.must_hold { "must" } else { "" },
            cell.verdict,
            note(&mut notes, &cell.detail)
        );
    }
    text.push('\n');
    for (i, note) in notes.iter().enumerate() {
        entry(&mut text, &format!("[{}]", i + 1), &[(*note).to_owned()]);
    }
    text
}

/// The number under which a detail is noted below: many cells share one.
fn note<'d>(notes: &mut Vec<&'d str>, detail: &'d str) -> String {
    if detail.is_empty() {
        return String::new();
    }
    let place = notes.iter().position(|note| *note == detail);
    let place = place.unwrap_or_else(|| {
        notes.push(detail);
        notes.len() - 1
    });
    format!("  [{}]", place + 1)
}

fn entry(text: &mut String, name: &str, paragraphs: &[String]) {
    let mut name = name;
    for paragraph in paragraphs {
        for line in wrapped(paragraph, WIDTH - INDENT) {
            let _ = writeln!(text, "{name:INDENT$}{line}");
            name = "";
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cells_share_is_noted_once() {
        let mut notes = Vec::new();
        assert_eq!(note(&mut notes, "slow"), "  [1]");
        assert_eq!(note(&mut notes, "fast"), "  [2]");
        assert_eq!(note(&mut notes, "slow"), "  [1]");
        assert_eq!(note(&mut notes, ""), "");
        assert_eq!(notes, ["slow", "fast"]);
    }
}

//! Words of the study: what its verb prints, and the text of its page.

mod case_text;
mod headline;
mod list;
mod summary;
mod table;

use crate::stability::cases_table::cases_table;
use crate::stability::story::Stories;
use crate::stability::{Matrix, report};
use crate::{Outcome, Picture, Section, StudyText};
use crepitus_pages::plot::Paper;
use crepitus_pages::words::footer;
pub use list::{markdown, value};
use serde::Serialize;
use summary::Summary;

/// A matrix, and what was asked for.
#[derive(Clone, Copy, Debug)]
pub struct StabilityOutcome<'m> {
    /// The matrix.
    pub matrix: &'m Matrix,
    /// Stories for the page.
    pub stories: Option<&'m Stories>,
    /// Number of subjects of the plan.
    pub subjects: usize,
    /// True if cases were named: everything about a single one is then printed.
    pub is_named: bool,
}

impl StabilityOutcome<'_> {
    /// Everything about the only case, if it was named.
    fn only(&self) -> Option<String> {
        match self.matrix.rows.as_slice() {
            [row] if self.is_named => Some(case_text::case(row)),
            _ => None,
        }
    }
}

impl Outcome for StabilityOutcome<'_> {
    const REST: &'static str = "every case";

    fn summary(&self) -> impl Serialize {
        Summary::new(self)
    }

    fn page(&self) -> String {
        report::html(self.matrix, self.stories, &text(self))
    }

    fn pictures(&self, paper: Paper) -> Vec<Picture> {
        report::pictures(self.matrix, self.stories, paper)
    }

    fn tables(&self) -> Vec<(&'static str, String)> {
        let cells: Vec<_> = self.matrix.cells().collect();
        vec![("cases.csv", cases_table(&cells).to_csv())]
    }

    fn answer(&self) -> String {
        headline::answer(self.matrix, &Summary::new(self))
    }

    fn in_short(&self) -> String {
        let table = self.only();
        table::broken(self.matrix) + &table.unwrap_or_else(|| headline::table(self.matrix))
    }

    fn in_full(&self) -> String {
        let table = self.only();
        table.unwrap_or_else(|| table::table(self.matrix, &Summary::new(self)))
            + &table::broken(self.matrix)
    }

    fn broken(&self) -> Option<String> {
        let mut broken = Vec::new();
        for (case, cell) in self.matrix.broken() {
            broken.push(format!("{} {} on {}", case.id, case.name, cell.subject));
        }
        match broken.as_slice() {
            [] => None,
            [only] => Some(format!("{only} must hold and does not")),
            several => Some(format!(
                "{} cells that must hold do not: {}",
                several.len(),
                several.join("; ")
            )),
        }
    }
}

fn text(tried: &StabilityOutcome<'_>) -> StudyText {
    let (matrix, summary) = (tried.matrix, Summary::new(tried));
    let counts = &summary.counts;
    let row = |name: &str, value: String| (name.to_owned(), value);
    StudyText {
        title: match matrix.rows.as_slice() {
            [only] => only.case.title.to_owned(),
            _ => "Which hard cases hold".to_owned(),
        },
        intro: headline::answer(matrix, &summary),
        tables: vec![Section {
            title: "The study".to_owned(),
            rows: vec![
                row("cases", summary.cases.len().to_string()),
                row(
                    "solvers under conventions, in precisions",
                    summary.subjects.to_string(),
                ),
                row("cells that hold", counts.holds.to_string()),
                row("cells that degrade", counts.degrades.to_string()),
                row("cells that fail", counts.fails.to_string()),
                row(
                    "cells that must hold",
                    format!("{}, {} broken", counts.must_hold, counts.broken),
                ),
                row(
                    "hours of simulated time",
                    if summary.long {
                        "included"
                    } else {
                        "left out: --long runs them"
                    }
                    .to_owned(),
                ),
                row("the study took", format!("{:.1} s", summary.wall_s)),
            ],
        }],
        notes: Vec::new(),
        footer: footer(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::{Cell, Failure, Row, Subject, Verdict, catalogue};

    /// One case in which the first of two subjects overflows.
    fn overflow(must_hold: bool) -> Matrix {
        let cells = Subject::all().into_iter().take(2).map(|subject| Cell {
            subject,
            must_hold,
            verdict: Verdict::Fails {
                what: Failure::Overflow,
                at_s: Some(0.25),
                flagged: false,
            },
            detail: "the first trial".to_owned(),
        });
        Matrix {
            rows: vec![Row {
                case: catalogue::find("H01").unwrap(),
                cells: cells.collect(),
            }],
            wall_s: 0.0,
        }
    }

    fn broken(matrix: &Matrix) -> Option<String> {
        let tried = StabilityOutcome {
            matrix,
            stories: None,
            subjects: 2,
            is_named: true,
        };
        tried.broken()
    }

    #[test]
    fn a_cell_that_must_hold_decides_the_exit_code_and_is_named() {
        assert_eq!(broken(&overflow(false)), None);
        assert_eq!(table::broken(&overflow(false)), "");
        let matrix = overflow(true);
        let message = broken(&matrix).unwrap();
        assert!(message.starts_with("2 cells"), "{message}");
        assert!(
            message.contains("H01 constant-speed on exact, frozen, f32"),
            "{message}"
        );
        let text = table::broken(&matrix);
        assert!(text.contains("overflow at t = 0.250 s"), "{text}");
        assert!(text.contains("the first trial"), "{text}");
    }
}

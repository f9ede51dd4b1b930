//! The files of the matrix: names and contents.

use super::headline;
use super::summary::Summary;
use crate::failure::Failure;
use crate::pictures::Pictures;
use crate::results::{Files, footer, report_files};
use crepitus_studies::stability::Matrix;
use crepitus_studies::stability::cases_table::cases_table;
use crepitus_studies::stability::report;
use crepitus_studies::stability::story::Stories;
use crepitus_studies::{Section, StudyText};

/// The report, the cells and the summary; the matrix and each story as an SVG
/// of its own if asked for.
pub(super) fn files(
    matrix: &Matrix,
    stories: Option<&Stories>,
    summary: &Summary<'_>,
    pictures: &Pictures,
) -> Result<Files, Failure> {
    let page = report::html(matrix, stories, &text(matrix, summary));
    let pictures = pictures.files(|paper| report::pictures(matrix, stories, paper))?;
    let mut files = report_files(page, summary, pictures)?;
    files.push((
        "cases.csv".to_owned(),
        cases_table(&matrix.cells()).to_csv().into(),
    ));
    Ok(files)
}

fn text(matrix: &Matrix, summary: &Summary<'_>) -> StudyText {
    let counts = &summary.counts;
    let row = |name: &str, value: String| (name.to_owned(), value);
    StudyText {
        title: match matrix.rows.as_slice() {
            [only] => only.case.title.to_owned(),
            _ => "Which hard cases hold".to_owned(),
        },
        intro: headline::answer(matrix, summary),
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

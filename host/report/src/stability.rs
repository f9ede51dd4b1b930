//! The report of the stability study: which hard cases hold, as a heat map
//! with numbers.
//!
//! ```text
//! Matrix ─┬─ Columns: convention × rung ─┬─> heat map ─┐
//!         └─ Look: colour, sign, number ─┼─> matrix.svg├─> page, pictures
//!                                        └─> details ──┤
//! stories ─────────────────────────────────────────────┘
//! ```
//!
//! What a verdict looks like is decided in one place (`look`), so that page
//! and picture cannot differ.

mod columns;
mod details;
mod heat_map;
mod look;
mod page;
mod picture;
mod scale;

use crepitus_study::stability::Matrix;
use crepitus_study::stability::story::Story;

use crate::picture::Picture;
use crate::{ReportError, Section, story};

/// The words of the report. All of them are escaped on the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StabilityText {
    /// The title of the page.
    pub title: String,
    /// What was studied and how; line breaks are kept.
    pub intro: String,
    /// The tables, in order, below the cases.
    pub tables: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

/// The report as one HTML page, complete in itself.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a story.
pub fn html(
    matrix: &Matrix,
    stories: &[Story],
    text: &StabilityText,
) -> Result<String, ReportError> {
    page::html(matrix, stories, text)
}

/// The matrix, in brief, and every story as files of their own.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a story.
pub fn pictures(matrix: &Matrix, stories: &[Story]) -> Result<Vec<Picture>, ReportError> {
    let mut pictures = vec![Picture {
        name: "matrix".to_owned(),
        svg: picture::svg(matrix),
    }];
    for story in stories {
        pictures.push(story::picture(story)?);
    }
    Ok(pictures)
}

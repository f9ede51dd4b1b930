//! The report of the accuracy study: what accuracy costs in time, as
//! work-precision diagrams.
//!
//! ```text
//! points → Study: pairs of scene and convention, rungs, precisions
//!            └ Pair × Measure × precision → Diagram: one curve a rung
//!                                           LeftOut: points no curve may show
//! ```
//!
//! A curve shows the error against the cost, one point a step. A solver that
//! finds the wrong number of events may look cheap and accurate, so its points
//! are in no curve but in a list below.

mod axes;
mod curve;
mod diagram;
pub(crate) mod hand;
mod labels;
mod left_out;
pub(crate) mod marker;
pub(crate) mod measure;
mod names;
pub(crate) mod overlay;
mod page;
mod pair;
mod steps;
mod target;
mod target_table;
mod tick_table;

use crepitus_study::accuracy::Point;
use crepitus_study::accuracy::target::OnTarget;

use crate::picture::{Picture, document};
use crate::{ReportError, Section};
use pair::Study;

/// The words of the report. All of them are escaped on the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AccuracyText {
    /// The title of the page.
    pub title: String,
    /// What was studied and how; line breaks are kept.
    pub intro: String,
    /// What a reader should know, one paragraph each, below the diagrams.
    pub notes: Vec<String>,
    /// The tables, in order, below the diagrams.
    pub tables: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

/// The report as one HTML page, complete in itself.
///
/// The pair of a scene with `0.988` in its name and the frozen convention
/// comes first and in full, the others below it, folded. What the ladder costs
/// on the target, if that is known, has a diagram in each and a table below.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a diagram.
pub fn html(
    points: &[Point],
    target: Option<&OnTarget>,
    text: &AccuracyText,
) -> Result<String, ReportError> {
    page::html(&Study::new(points), target, text)
}

/// Every diagram as a file of its own, named after what it shows:
/// `event-time-constant-0-988-frozen-f64`, `target-constant-0-988-frozen-f32`.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a diagram.
pub fn pictures(points: &[Point]) -> Result<Vec<Picture>, ReportError> {
    let study = Study::new(points);
    let mut pictures = Vec::new();
    for pair in &study.pairs {
        let mut diagrams = diagram::all(&study, pair)?;
        diagrams.extend(target::diagram(&study, pair)?);
        for diagram in diagrams {
            pictures.push(Picture {
                name: diagram.name,
                svg: document(&diagram.svg, &diagram.legend),
            });
        }
    }
    Ok(pictures)
}

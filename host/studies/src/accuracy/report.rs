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
mod left_out;
pub(crate) mod measure;
mod names;
mod page;
mod pair;
mod steps;
mod studied_tables;
mod target;
mod tick_table;

use crate::accuracy::{Point, Study as Results};

use crate::{Paper, Picture, StudyText};
use pair::Study;

/// The report as one HTML page, complete in itself.
///
/// The pair of a scene with `0.988` in its name and the frozen convention
/// comes first and in full, the others below it, folded. What the ladder costs
/// on the target, if that is known, has a diagram in each and a table below; so have
/// the other symptoms and the stage of the vibration actuator, if they were studied.
pub fn html(results: &Results, text: &StudyText) -> String {
    page::html(results, text)
}

/// Every diagram as a file of its own, named after what it shows:
/// `event-time-constant-0-988-frozen-f64`, `target-constant-0-988-frozen-f32`.
pub fn pictures(points: &[Point], paper: Paper) -> Vec<Picture> {
    let study = Study::new(points);
    let mut pictures = Vec::new();
    for pair in &study.pairs {
        let diagrams = diagram::all(&study, pair, paper)
            .into_iter()
            .chain(target::diagram(&study, pair, paper));
        pictures.extend(diagrams.map(|d| Picture::new(d.name, &d.svg, &d.legend, &[])));
    }
    pictures
}

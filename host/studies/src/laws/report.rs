//! The report of the study: which law to take, at a glance and in every number.
//!
//! ```text
//! rows ──> law × quantity ─┬─> two heat maps: model errors, numerical errors
//!                          ├─> error for grating against the cost of a step
//!                          └─> model error against numerical error
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | an error as a share, or that there is none | `share` |
//! | colours of shares | `scale` |
//! | laws as signs between two axes | `spots` |

mod heat_map;
mod page;
mod scale;
mod share;
mod spots;
mod two_errors;
mod work_precision;

use crate::laws::LawStudy;
use crate::laws::ranking::Answer;
use crate::{Paper, Picture, StudyText};
use crepitus_pages::plot::Figure;

/// The report as one HTML page, complete in itself.
pub fn html(study: &LawStudy, answers: &[Answer], text: &StudyText) -> String {
    page::html(study, answers, text)
}

/// Every figure as a file of its own: `model-errors`, `numerical-errors`, `grating-cost`,
/// `grating-cycles`, `two-errors`.
pub fn pictures(study: &LawStudy, answers: &[Answer], paper: Paper) -> Vec<Picture> {
    let inks = scale::inks();
    let figures = figures(study, answers, paper);
    let pictures = figures.iter().flat_map(|figure| {
        let charts = figure.charts.iter();
        charts.map(|chart| Picture::new(figure.name.to_owned(), &chart.svg, &figure.legend, &inks))
    });
    pictures.collect()
}

/// The figures, in the order of the page.
fn figures(study: &LawStudy, answers: &[Answer], paper: Paper) -> Vec<Figure> {
    let mut figures = work_precision::figures(study, answers, paper);
    figures.extend(heat_map::figures(study, answers, paper));
    figures.extend(two_errors::figure(study, paper));
    figures
}

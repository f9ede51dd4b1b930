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

pub use page::html;

use crate::stability::Matrix;
use crate::stability::story::{Stories, figures};
use crate::{Paper, Picture};

/// The matrix, in brief, and every story as files of their own.
pub fn pictures(matrix: &Matrix, stories: Option<&Stories>, paper: Paper) -> Vec<Picture> {
    let figures = stories.map_or_else(Vec::new, |stories| figures(stories, paper));
    let mut pictures = vec![picture::picture(matrix)];
    pictures.extend(crepitus_pages::plot::pictures(&figures));
    pictures
}

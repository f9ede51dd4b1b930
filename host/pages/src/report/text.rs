//! The words of a report, as its author hands them over. All of them are
//! escaped on the page.

use crate::plot::page::Section;

/// The words of a report.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text {
    /// The title of the page: that of the scene.
    pub title: String,
    /// Description of the scene; line breaks are kept.
    pub description: Option<String>,
    /// Warnings for the reader of the figures: in a box at
    /// the top.
    pub warnings: Vec<String>,
    /// The tables, in order.
    pub sections: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

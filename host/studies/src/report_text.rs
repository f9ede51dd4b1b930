//! The words of a study's page.

use crepitus_pages::plot::page::Section;

/// The words of a page. All of them are escaped on it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StudyText {
    /// The title of the page.
    pub title: String,
    /// Subject, method and result; line breaks are kept.
    pub intro: String,
    /// Notes for the reader, one paragraph each, at the end.
    pub notes: Vec<String>,
    /// The tables, in order, below the charts.
    pub tables: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

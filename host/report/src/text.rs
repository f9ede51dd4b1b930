//! The words of a report, as its author hands them over. All of them are
//! escaped on the page.

/// One table of the summary.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// The heading of the table.
    pub title: String,
    /// What is reported, and its value with its unit.
    pub rows: Vec<(String, String)>,
}

/// The words of a report.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text {
    /// The title of the page: that of the scene.
    pub title: String,
    /// What the scene is about; line breaks are kept.
    pub description: Option<String>,
    /// What the reader must know before believing the figures: in a box at
    /// the top.
    pub warnings: Vec<String>,
    /// The tables, in order.
    pub sections: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

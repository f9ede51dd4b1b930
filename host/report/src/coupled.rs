//! The report of where the device stays quiet on a leg: the map, and what the
//! presets have left.

mod map;
mod margins;
mod page;

use crate::Section;
use crate::picture::Picture;
use crepitus_study::coupled::CoupledStudy;

/// The words of the report. All of them are escaped on the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CoupledText {
    /// The title of the page.
    pub title: String,
    /// The study in a few sentences.
    pub intro: String,
    /// The tables, in order.
    pub tables: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

/// The report as one HTML page, complete in itself.
pub fn html(study: &CoupledStudy, text: &CoupledText) -> String {
    page::html(study, text)
}

/// The map as a file of its own.
pub fn pictures(study: &CoupledStudy) -> Vec<Picture> {
    vec![Picture {
        name: "z-width".to_owned(),
        svg: map::svg(study).into_string(),
    }]
}

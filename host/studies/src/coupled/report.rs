//! The report of where the device stays quiet on a leg: the map, and what the
//! presets have left.

mod map;
mod margins;
mod page;

use crate::coupled::CoupledStudy;
use crate::{Picture, StudyText};

/// The report as one HTML page, complete in itself.
pub fn html(study: &CoupledStudy, text: &StudyText) -> String {
    page::html(study, text)
}

/// The map as a file of its own.
pub fn pictures(study: &CoupledStudy) -> Vec<Picture> {
    vec![Picture::new(
        "z-width".to_owned(),
        &map::svg(study),
        &[],
        &map::INKS,
    )]
}

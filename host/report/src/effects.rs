//! The report of the study of effects: what each effect of a scene does to the
//! torque at the hand, against what it costs.
//!
//! ```text
//! EffectsStudy ─┬─> table ──────────────────────────────┐
//!               ├─> influence against cost ─┐           ├─> page
//!               ├─> bands, a row a variant ─┼─> pictures┤
//!               ├─> story: the torque ──────┘           │
//!               └─> the smallest set ───────────────────┘
//! ```

mod bands;
mod hand;
mod influence;
mod page;
mod smallest;
mod spots;
mod table;

use crepitus_study::effects::EffectsStudy;

use crate::picture::{Picture, document};
use crate::{ReportError, Section, story};

/// The words of the report. All of them are escaped on the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EffectsText {
    /// The title of the page.
    pub title: String,
    /// What was studied, and what was found; line breaks are kept.
    pub intro: String,
    /// What a reader should know, one paragraph each, at the end.
    pub notes: Vec<String>,
    /// The tables, in order, below the figures.
    pub tables: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}

/// The report as one HTML page, complete in itself.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a figure.
pub fn html(study: &EffectsStudy, text: &EffectsText) -> Result<String, ReportError> {
    page::html(study, text)
}

/// Every figure as a file of its own.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a figure.
pub fn pictures(study: &EffectsStudy) -> Result<Vec<Picture>, ReportError> {
    let mut pictures = Vec::new();
    for figure in [influence::figure(study)?, bands::figure(study)?]
        .into_iter()
        .flatten()
    {
        for chart in &figure.charts {
            pictures.push(Picture {
                name: figure.name.to_owned(),
                svg: document(&chart.svg, &figure.legend),
            });
        }
    }
    for told in [&study.story, &study.build_up_story].into_iter().flatten() {
        pictures.push(story::picture(told)?);
    }
    Ok(pictures)
}

//! The page of the study.

use crepitus_study::effects::EffectsStudy;
use maud::html;

use super::{EffectsText, bands, influence, smallest, table};
use crate::{ReportError, frame, story};

/// The page looks like that of the accuracy study, with a wider table.
const LAYOUT: &str = concat!(
    include_str!("../accuracy/page.css"),
    include_str!("page.css")
);

pub(super) fn html(study: &EffectsStudy, text: &EffectsText) -> Result<String, ReportError> {
    let mut figures = Vec::new();
    figures.extend(influence::figure(study)?);
    figures.extend(bands::figure(study)?);
    for told in [&study.story, &study.build_up_story].into_iter().flatten() {
        figures.push(story::figure(told)?);
    }
    let body = html! {
        header {
            p.kicker { "Crepitus · what each effect does and costs" }
            h1 { (text.title) }
            @if !text.intro.is_empty() { p.description { (text.intro) } }
        }
        @if !study.warnings.is_empty() {
            aside.warnings role="note" aria-label="Warnings" {
                h2 { "Before you believe the numbers" }
                ul { @for warning in &study.warnings { li { (warning) } } }
            }
        }
        main {
            @if let Some(answer) = &study.answer { (smallest::section(answer)) }
            (table::table(study))
            @for figure in &figures { (frame::figure(figure)) }
            (frame::tables(&text.tables))
            @if !text.notes.is_empty() {
                section.notes {
                    h2 { "Notes" }
                    @for note in &text.notes { p { (note) } }
                }
            }
        }
        (frame::footer(&text.footer))
    };
    Ok(frame::document(&text.title, LAYOUT, &body))
}

//! The page of the study.

use crate::effects::EffectsStudy;
use maud::html;

use super::{figures, smallest, table};
use crate::StudyText;
use crepitus_pages::plot::page;

/// The page looks like that of the accuracy study, with a wider table.
const LAYOUT: &str = concat!(
    include_str!("../../accuracy/report/page.css"),
    include_str!("page.css")
);

pub(super) fn html(study: &EffectsStudy, text: &StudyText) -> String {
    let body = html! {
        header {
            p.kicker { "Crepitus · what each effect does and costs" }
            h1 { (text.title) }
            @if !text.intro.is_empty() { p.description { (text.intro) } }
        }
        (page::warnings("Before you believe the numbers", &study.warnings))
        main {
            @if let Some(answer) = &study.answer { (smallest::section(answer)) }
            (page::figures(|paper| figures(study, paper)))
            (table::table(study))
            (page::tables(&text.tables))
            (page::notes(&text.notes))
        }
        (page::footer(&text.footer))
    };
    page::document(&text.title, LAYOUT, &[], &body)
}

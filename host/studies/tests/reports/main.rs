//! The reports of the studies, from rows to pages: see each module.
// Small whole numbers.
#![allow(clippy::cast_precision_loss)]

mod accuracy;
mod effects;
#[path = "../../../pages/tests/pages/markup.rs"]
mod markup;
#[path = "fixture/matrix.rs"]
mod matrix;
mod stability;
#[path = "fixture/study.rs"]
mod study;

use crepitus_studies::{Section, StudyText};

/// Markup in every text of a page.
fn evil_text() -> StudyText {
    let evil = || "<script>alert('&')</script>".to_owned();
    StudyText {
        title: evil(),
        intro: evil(),
        notes: vec![evil()],
        tables: vec![Section {
            title: evil(),
            rows: vec![(evil(), evil())],
        }],
        footer: evil(),
    }
}

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

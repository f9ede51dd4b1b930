//! Identified values as a table.

use crate::sections::counts;
use crepitus_identify::brace::{Brace, QuantityResult, Shown};
use crepitus_pages::table::Table;
use std::fmt::Write;

/// A value with the digits of its interval.
fn value(shown: &Shown) -> [String; 2] {
    match &shown.result {
        QuantityResult::Seen(estimate) => {
            let (value, half_width) = estimate.rounded();
            [value, format!("± {half_width}")]
        }
        QuantityResult::NotVisible { .. } => ["not visible".to_owned(), String::new()],
    }
}

/// Text for people: the values, then the reasons why others are missing.
pub(super) fn text(brace: &Brace) -> String {
    let mut text = Table::of(&brace.shown)
        .people("quantity", |shown| shown.quantity.name())
        .people("value", |shown| value(shown)[0].clone())
        .right()
        .people("95 %", |shown| value(shown)[1].clone())
        .people("unit", |shown| shown.quantity.spec().unit)
        .people("in a scene", |shown| {
            format!("{}.{}", shown.quantity.effect(), shown.quantity.spec().key)
        })
        .to_text();
    text.push('\n');
    for shown in &brace.shown {
        if let QuantityResult::NotVisible { why } = &shown.result {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{}: not visible in this recording, because {why}",
                shown.quantity.name()
            );
        }
    }
    let (swings, seconds) = brace.swung();
    let _ = writeln!(
        text,
        "{}, {seconds:.1} s, up to {:.0}°; the fit leaves {:.4}° rms.",
        counts(&[(swings as u64, "swing")]),
        brace.amplitude_rad.to_degrees(),
        brace.rms_rad.to_degrees()
    );
    text
}

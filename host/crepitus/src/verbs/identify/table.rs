//! Identified values as a table and as JSON.

use crate::sections::counts;
use crepitus_identify::brace::{Brace, QuantityResult, Shown, Weight};
use crepitus_pages::table::Table;
use serde_json::{Value, json};
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

/// Returns the values of the brace as JSON.
pub(super) fn summary(brace: &Brace, weight: &Weight) -> Value {
    let values: Vec<Value> = (brace.shown.iter())
        .map(|shown| {
            let spec = shown.quantity.spec();
            let (value, half_width, why) = match &shown.result {
                QuantityResult::Seen(e) => (Some(e.value), Some(e.half_width), None),
                QuantityResult::NotVisible { why } => (None, None, Some(why)),
            };
            json!({
                "quantity": shown.quantity.name(),
                "effect": shown.quantity.effect(),
                "key": spec.key,
                "unit": spec.unit,
                "value": value,
                "half_width": half_width,
                "not_visible": why,
            })
        })
        .collect();
    let (swings, seconds) = brace.swung();
    json!({
        "values": values,
        "swings": swings,
        "swung_s": seconds,
        "amplitude_deg": brace.amplitude_rad.to_degrees(),
        "residual_deg": brace.rms_rad.to_degrees(),
        "weight_moment_nm": weight.moment_nm.value,
        "weight_inertia_kg_m2": weight.inertia_kg_m2.value,
        "notes": brace.notes,
    })
}

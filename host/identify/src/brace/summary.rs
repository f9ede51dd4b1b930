//! Identified values as JSON.

use super::{Brace, QuantityResult, Weight};
use serde_json::{Value, json};

/// Returns the values of the brace as JSON.
pub fn summary(brace: &Brace, weight: &Weight) -> Value {
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

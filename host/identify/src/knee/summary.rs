//! A fitted knee as JSON.

use super::{Candidate, Grade, KneeFit};
use serde_json::{Value, json};

fn candidate(it: &Candidate) -> Value {
    let values: Vec<Value> = (it.values.iter())
        .map(|value| {
            let half_width = value.estimate.half_width;
            json!({
                "key": value.key,
                "unit": value.unit,
                "value": value.estimate.value,
                "half_width": half_width.is_finite().then_some(half_width),
                "is_told": value.is_told,
            })
        })
        .collect();
    json!({
        "symptom": it.symptom.name(),
        "effect": it.symptom.effect(),
        "muscles": if it.is_flexor { "flexors" } else { "extensors" },
        "values": values,
        "residual_nm": it.residual_nm,
        "left_out_nm": it.left_out_nm,
        "largest_nm": it.largest_nm,
    })
}

/// Returns the fit as JSON.
pub fn summary(fitted: &KneeFit, grade: Option<&Grade>) -> Value {
    let strokes: Vec<Value> = (fitted.strokes.iter())
        .map(|stroke| {
            json!({
                "begins_s": stroke.begins_s,
                "from_deg": stroke.from_deg,
                "to_deg": stroke.to_deg,
                "peak_deg_s": stroke.peak_deg_s,
            })
        })
        .collect();
    let untold: Vec<Value> = (fitted.untold.iter())
        .map(|(symptom, why)| json!({ "symptom": symptom.name(), "why": why }))
        .collect();
    json!({
        "proposed": candidate(&fitted.best),
        "next": candidate(&fitted.second),
        "grade": grade.map(|grade| json!({
            "preset": grade.preset.name,
            "severity": grade.preset.severity,
            "steps": grade.distance,
            "is_far": grade.is_far(),
            "next": grade.next.map(|(name, steps)| json!({ "preset": name, "steps": steps })),
        })),
        "friction_nm": { "value": fitted.friction_nm.value, "half_width": fitted.friction_nm.half_width },
        "unexplained": {
            "rms_nm": fitted.unexplained.rms_nm,
            "share": fitted.unexplained.share,
            "by_angle": fitted.unexplained.by_angle.iter()
                .map(|(deg, nm)| json!({ "deg": deg, "rms_nm": nm })).collect::<Vec<_>>(),
        },
        "cannot_be_told": untold,
        "strokes": strokes,
    })
}

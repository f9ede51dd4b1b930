//! A fitted knee as text.

use crepitus_identify::knee::{Candidate, Grade, KneeFit, Value as Fitted};
use crepitus_pages::table::Table;
use std::fmt::Write;

/// A value with the digits of its interval.
fn rounded(value: &Fitted) -> [String; 2] {
    if !value.estimate.half_width.is_finite() {
        return [
            format!("{:.1}", value.estimate.value),
            "between two strokes".to_owned(),
        ];
    }
    let (number, half_width) = value.estimate.rounded();
    let how = if value.is_told { "" } else { ", not told" };
    [number, format!("± {half_width}{how}")]
}

fn named(candidate: &Candidate) -> String {
    let muscles = match candidate.symptom.effect() {
        Some("spasticity" | "clasp-knife" | "clonus") if candidate.is_flexor => " of the flexors",
        Some("spasticity" | "clasp-knife" | "clonus") => " of the extensors",
        _ => "",
    };
    format!("{}{muscles}", candidate.symptom.name())
}

/// Text for people.
pub(super) fn text(fitted: &KneeFit, grade: Option<&Grade>) -> String {
    let best = &fitted.best;
    let mut text = format!("{}\n", named(best));
    // Writing to a String cannot fail.
    if let Some(grade) = grade {
        let severity = grade.preset.severity.as_deref().unwrap_or("");
        let far = if grade.is_far() {
            "; far from every preset"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "nearest preset: {} ({severity}), {:.1} steps away{far}",
            grade.preset.name, grade.distance
        );
    }
    if !best.values.is_empty() {
        text.push('\n');
        text += &Table::of(&best.values)
            .people("value", |value| value.key)
            .people("fitted", |value| rounded(value)[0].clone())
            .right()
            .people("95 %", |value| rounded(value)[1].clone())
            .people("unit", |value| value.unit)
            .to_text();
    }
    let (friction, half_width) = fitted.friction_nm.rounded();
    let unexplained = &fitted.unexplained;
    let _ = writeln!(
        text,
        "\ndry friction of limb and apparatus: {friction} ± {half_width} N·m\n\
         not explained: {:.3} N·m rms, {:.1} % of the torque's variance",
        unexplained.rms_nm,
        100.0 * unexplained.share
    );
    let worst = unexplained
        .by_angle
        .iter()
        .max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((angle_deg, rms_nm)) = worst {
        let _ = writeln!(text, "  most about {angle_deg:.0}°: {rms_nm:.3} N·m rms");
    }
    let _ = writeln!(
        text,
        "error in strokes left out: {:.4} N·m rms; of the next model, {}: {:.4}",
        best.left_out_nm,
        named(&fitted.second),
        fitted.second.left_out_nm
    );
    for (symptom, why) in &fitted.untold {
        let _ = writeln!(text, "cannot be told: {}: {why}", symptom.name());
    }
    text
}

//! A scene of a fitted knee.

use super::{Grade, KneeFit};
use std::fmt::Write;
use std::path::Path;

/// Returns a scene of the fitted knee, examined over the same range. Values that a device does not show are at the
/// end of its range, with a comment.
pub fn scene(fitted: &KneeFit, grade: Option<&Grade>, file: &Path) -> String {
    let ends = fitted
        .strokes
        .iter()
        .flat_map(|stroke| [stroke.from_deg, stroke.to_deg]);
    let (low, high) = ends.fold((f64::MAX, f64::MIN), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let fastest = fitted
        .strokes
        .iter()
        .map(|stroke| stroke.peak_deg_s)
        .fold(0.0, f64::max);
    let best = &fitted.best;
    let name = file.file_name().map_or_else(String::new, |name| {
        name.to_string_lossy().replace(['"', '\\'], "_")
    });
    let nearest = grade.map_or_else(String::new, |grade| {
        format!("; nearest preset: {}", grade.preset.name)
    });
    let mut text = format!(
        "version = 1\n\
         title = \"A fitted knee\"\n\
         description = \"{}, fitted to {name}{nearest}\"\n\
         duration_s = 12.0\n\n\
         [motion]\n\
         kind = \"strokes\"\n\
         from_deg = {:.1}\n\
         to_deg = {:.1}\n\
         peak_speed_deg_s = {:.0}\n\
         pause_s = 0.5\n\n\
         [solver]\n\
         kind = \"exact-events\"\n\
         step_s = 5e-5\n\
         precision = \"f32\"\n\n\
         [output]\n\
         trace_step_s = 1e-3\n",
        best.symptom.name(),
        low,
        high,
        fastest.clamp(5.0, 300.0)
    );
    let Some(effect) = best.symptom.effect() else {
        return text;
    };
    // Writing to a String cannot fail.
    let _ = writeln!(text, "\n[effects.{effect}]");
    if let Some((key, choice)) = best.symptom.choice() {
        let _ = writeln!(text, "{key} = \"{choice}\"");
    }
    if matches!(effect, "spasticity" | "clasp-knife" | "clonus") && best.is_flexor {
        text.push_str("muscles = \"flexors\"\n");
    }
    for value in &best.values {
        let (least, most) = value.range;
        let shown = value.estimate.value.clamp(least, most);
        let beyond = if shown == value.estimate.value {
            String::new()
        } else {
            format!(
                "; fitted {:.3}, beyond what a device shows",
                value.estimate.value
            )
        };
        let half_width = value.estimate.half_width;
        let interval = if half_width.is_finite() {
            format!("± {half_width:.2e}")
        } else {
            "between two strokes".to_owned()
        };
        let _ = writeln!(
            text,
            "{} = {shown:.6}  # {interval} {}{beyond}",
            value.key, value.unit
        );
    }
    text
}

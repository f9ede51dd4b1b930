//! The files of a fit.

use super::grade::Grade;
use crate::failure::Failure;
use crate::results::{json_file, write as write_files};
use crepitus_files::output::{Folder, NewFile};
use crepitus_identify::knee::KneeFit;
use serde_json::Value;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

const VALUES: &str = "fit.json";
const RESIDUAL: &str = "residual.csv";
const SCENE: &str = "knee.toml";

/// Names of all files.
pub(super) const NAMES: [&str; 3] = [VALUES, RESIDUAL, SCENE];

/// Returns a scene of the fitted knee, examined over the same range. Values that a device does not show are at the
/// end of its range, with a comment.
pub(super) fn scene(fitted: &KneeFit, grade: Option<&Grade>, file: &Path) -> String {
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

/// Writes values, residual and scene.
pub(super) fn write(
    out: &Path,
    folder: Folder,
    fitted: &KneeFit,
    summary: &Value,
    scene: &str,
) -> Result<(), Failure> {
    let mut residual = "t_s,angle_rad,torque_nm,symptom_nm,residual_nm\n".to_owned();
    for point in fitted.curve() {
        let [t, angle, torque, symptom, rest] = point;
        let _ = writeln!(
            residual,
            "{t:.4},{angle:.6},{torque:.5},{symptom:.5},{rest:.5}"
        );
    }
    let files = vec![
        json_file(VALUES, summary)?,
        (RESIDUAL.to_owned(), residual.into_bytes()),
        (SCENE.to_owned(), scene.as_bytes().to_vec()),
    ];
    write_files(folder, out, files)
}

/// Writes the scene, whole or not at all.
pub(super) fn write_scene(file: NewFile, scene: &str) -> Result<(), Failure> {
    let written = file.as_file().write_all(scene.as_bytes());
    written.map_err(|e| Failure::Work(format!("--scene-out: cannot be written: {e}")))?;
    Ok(file.persist()?)
}

//! The files of a fit.

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

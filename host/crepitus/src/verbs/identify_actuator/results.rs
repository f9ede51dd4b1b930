//! The files of an identification.

use super::chart;
use super::recorded::Measured;
use crate::failure::Failure;
use crate::results::{Files, summary_file, svg_files, write as write_files};
use crepitus_files::output::Folder;
use crepitus_identify::actuator::Actuator;
use serde_json::Value;
use std::path::Path;

/// The plot of impedance and residual.
pub(super) const PLOT: &str = "impedance.svg";

/// Measurements of chirps that were played.
const MEASURED: [&str; 2] = ["measured.csv", "measured-added.csv"];

/// Names of all files.
pub(super) fn names(is_played: bool) -> Vec<&'static str> {
    let measured: &[_] = if is_played { &MEASURED } else { &[] };
    [&["summary.json", PLOT], measured].concat()
}

/// Writes the plot and the summary of what was found, and what a chirp that was played has
/// shown.
pub(super) fn write(
    out: &Path,
    folder: Folder,
    found: Option<(&Actuator, &Value)>,
    measured: Option<&Measured>,
) -> Result<(), Failure> {
    let mut files = Files::new();
    if let Some((actuator, summary)) = found {
        files.push(summary_file(summary)?);
        files.extend(svg_files([&chart::figure(actuator)]));
    }
    if let Some(measured) = measured {
        files.push((MEASURED[0].to_owned(), measured.bare.to_csv().into()));
        if let Some(with_added) = &measured.with_added {
            files.push((MEASURED[1].to_owned(), with_added.to_csv().into()));
        }
    }
    write_files(folder, out, files)
}

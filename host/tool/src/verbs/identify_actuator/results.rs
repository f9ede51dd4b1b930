//! The files of an identification.

use crate::failure::Failure;
use crate::results::{Files, folder, summary_file, write as write_files};
use crepitus_identify::{Actuator, chart};
use crepitus_plot::pictures;
use serde_json::Value;
use std::path::Path;

/// The plot of impedance and residual.
pub(super) const PLOT: &str = "impedance.svg";

/// Writes the plot and the summary.
pub(super) fn write(out: &Path, found: &Actuator, summary: &Value) -> Result<(), Failure> {
    let folder = folder(out)?;
    let mut files: Files = vec![summary_file(summary)?];
    for picture in pictures([&chart::figure(found)]) {
        files.push((format!("{}.svg", picture.name), picture.svg.into()));
    }
    write_files(folder, out, files)
}

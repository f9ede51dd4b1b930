//! The files of an identification.

use super::recorded::Measured;
use crate::failure::Failure;
use crate::results::{Files, summary_file, svg_files, write as write_files};
use crepitus_identify::actuator::{Actuator, Series, chart};
use crepitus_scene::output::Folder;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// The plot of impedance and residual.
pub(super) const PLOT: &str = "impedance.svg";

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
        files.push(("measured.csv".to_owned(), csv(&measured.bare).into()));
        if let Some(with_added) = &measured.with_added {
            files.push(("measured-added.csv".to_owned(), csv(with_added).into()));
        }
    }
    write_files(folder, out, files)
}

/// As `--from` reads it.
fn csv(series: &Series) -> String {
    let mut text = "t_s,volts,amperes\n".to_owned();
    for (i, (volts, amperes)) in (0_u32..).zip(series.volts().iter().zip(series.amperes())) {
        let time_s = f64::from(i) * series.step_s();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{time_s:.6},{volts:.7},{amperes:.6}");
    }
    text
}

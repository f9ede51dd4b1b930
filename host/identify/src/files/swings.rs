//! Recordings as the estimator takes them.

use super::swung_table::{self, SwingColumns};
use super::{FileError, refused};
use crate::brace::{Recording, Sample};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{DeviceSettings, TICK_S};
use crepitus_recording::{Damage, ReadError, Recording as File};
use std::path::{Path, PathBuf};

/// Rows between two looks at Ctrl-C.
const ROWS: usize = 1 << 14;

/// Reads recordings of a device; what is none is read as a table. `progress` gets the share of each, 0 to 1, and
/// ends the reading by returning false.
///
/// # Errors
/// [`FileError`].
pub fn read_swings(
    files: &[PathBuf],
    table: &SwingColumns,
    warn: &mut dyn FnMut(&str),
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<Vec<Recording>, FileError> {
    let mut one = |path: &PathBuf| match File::open(path, Damage::Refuse) {
        Ok(file) => one(&file, path, progress),
        Err(error @ ReadError::Foreign(_)) => {
            swung_table::read(path, table, warn).map_err(|failure| match failure {
                FileError::Refused(of_table) => {
                    refused(format!("{error}; and no table of a swing: {of_table}"))
                }
                FileError::Interrupted => failure,
            })
        }
        Err(error) => Err(refused(error)),
    };
    files.iter().map(&mut one).collect()
}

fn one(
    file: &File,
    path: &Path,
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<Recording, FileError> {
    let settings = settings(file, path)?;
    let total = file.accounting().totals.received.max(1);
    let mut samples = Vec::new();
    for row in file.rows().map_err(refused)? {
        let row = row.map_err(refused)?;
        samples.push(Sample {
            tick: row.tick,
            count: row.count,
            current_a: row.current_a,
            is_lost: row.flags.has(SampleFlags::LOST),
        });
        if samples.len().is_multiple_of(ROWS) {
            let goes_on = progress(samples.len() as f64 / total as f64);
            if !goes_on {
                return Err(FileError::Interrupted);
            }
        }
    }
    Ok(recording(samples, &settings))
}

/// Samples of a device with these settings.
pub fn recording(samples: Vec<Sample>, settings: &DeviceSettings) -> Recording {
    Recording {
        samples,
        tick_s: TICK_S,
        rad_per_count: settings.encoder.rad_per_count(),
        torque_constant_nm_per_a: settings.motor.torque_constant_nm_per_a,
        gear_ratio: settings.encoder.gear_ratio,
    }
}

/// Encoder and motor of all parameters that were in force; they must not change.
fn settings(file: &File, path: &Path) -> Result<DeviceSettings, FileError> {
    let bad = |what: &str| refused(format!("{}: {what}", path.display()));
    let mut in_force = file.parameters().in_force();
    let mut found: Option<DeviceSettings> = None;
    for set in &file.parameters().0 {
        in_force.at(set.first_row);
        let Some(values) = in_force.values() else {
            continue;
        };
        let settings = DeviceSettings::of(&values)
            .map_err(|_| bad("its parameters are invalid: was it made by another version?"))?;
        if let Some(first) = &found
            && (first.encoder != settings.encoder || first.motor != settings.motor)
        {
            return Err(bad(
                "encoder or motor change within the recording: record again, with one set of parameters",
            ));
        }
        found.get_or_insert(settings);
    }
    found.ok_or_else(|| {
        bad("the parameters that were in force are unknown, and with them encoder and motor")
    })
}

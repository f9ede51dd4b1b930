//! Recordings as the estimator takes them.

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;
use crepitus_identify::brace::{Recording, Sample};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{DeviceSettings, TICK_S};
use crepitus_recording::{Damage, Recording as File};
use std::path::{Path, PathBuf};

/// Rows between two looks at Ctrl-C.
const ROWS: usize = 1 << 14;

/// Reads them all.
pub(super) fn read(files: &[PathBuf]) -> Result<Vec<Recording>, Failure> {
    let mut progress = Progress::of_reading();
    files.iter().map(|file| one(file, &mut progress)).collect()
}

fn one(path: &Path, progress: &mut Progress) -> Result<Recording, Failure> {
    let file = File::open(path, Damage::Refuse).map_err(Failure::input)?;
    let settings = settings(&file, path)?;
    let total = file.accounting().totals.received.max(1);
    let mut samples = Vec::new();
    for row in file.rows().map_err(Failure::input)? {
        let row = row.map_err(Failure::input)?;
        samples.push(Sample {
            tick: row.tick,
            count: row.count,
            current_a: row.current_a,
            is_lost: row.flags.has(SampleFlags::LOST),
        });
        if samples.len().is_multiple_of(ROWS) {
            #[expect(clippy::cast_precision_loss, reason = "a share")]
            progress.reached(samples.len() as f64 / total as f64);
            if interrupt::requested() {
                return Err(Failure::interrupted());
            }
        }
    }
    Ok(recording(samples, &settings))
}

/// Samples of a device with these settings.
pub(crate) fn recording(samples: Vec<Sample>, settings: &DeviceSettings) -> Recording {
    Recording {
        samples,
        tick_s: TICK_S,
        rad_per_count: settings.encoder.rad_per_count(),
        torque_constant_nm_per_a: settings.motor.torque_constant_nm_per_a,
        gear_ratio: settings.encoder.gear_ratio,
    }
}

/// Encoder and motor of all parameters that were in force; they must not change.
fn settings(file: &File, path: &Path) -> Result<DeviceSettings, Failure> {
    let bad = |what: &str| Failure::Input(format!("{}: {what}", path.display()));
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

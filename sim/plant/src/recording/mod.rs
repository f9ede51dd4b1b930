//! A recorded knee motion, read from a file and made a C² function of time.
//!
//! ```text
//! .csv ──────────┐
//!                ├─ read ─> Samples ─ smooth ─> one cubic per interval: φ, Ω, Ω̇ continuous
//! .mot, .sto ────┘          s, rad
//! ```
//! [`read`] takes two columns of a table and validates them: an impossible motion is an error that
//! names the file, line and column; an unusual one is a [`Warning`]. [`smooth`] is a zero-phase
//! low-pass and an interpolation in one. Both are needed: a recording carries noise that
//! differentiating amplifies, and a jump of Ω̇ is a jump of torque under the `physical` convention.
//! [`smooth_cycle`] makes a motion without end of one recorded cycle.

mod csv_file;
mod cyclic_bands;
mod error;
mod opensim_file;
mod repeat;
mod smooth;
mod smoothing_spline;
mod table;
mod warning;

#[cfg(test)]
mod test_cells;
#[cfg(test)]
mod test_data;
#[cfg(test)]
mod test_read;
#[cfg(test)]
mod test_repeat;
#[cfg(test)]
mod test_smooth;

pub use error::{Place, RecordingError};
pub use repeat::{MAX_JOIN_DEG, smooth_cycle};
pub use smooth::{CubicSegment, acceleration_ripple_rad_s2, smooth};
pub use warning::Warning;

use crepitus_files::input::{self, InputError};
use std::fmt;
use std::fs::File;
use std::path::Path;

/// The fewest samples that make a motion: a cubic has four coefficients.
pub const MIN_SAMPLES: usize = 4;

/// The most rows that are read, 28 hours at 200 Hz: two columns of them fill 320 MB.
pub const MAX_ROWS: usize = 20_000_000;

/// The largest file that is read, in bytes.
pub const MAX_BYTES: u64 = 2 << 30;

/// Location of the motion in the file.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// The file; `.mot` and `.sto` are read as OpenSim tables, everything else as CSV.
    pub path: &'a Path,
    /// The name of the column with the time in seconds.
    pub time_column: &'a str,
    /// The name of the column with the joint angle.
    pub angle_column: &'a str,
    /// The unit of the angle column; `None` for a column of something else, whose numbers are
    /// taken as they are.
    pub unit: Option<AngleUnit>,
}

/// The unit of a column of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
}

impl AngleUnit {
    /// The largest plausible angle, in this unit: 2000°, far beyond any joint.
    pub const fn limit(self) -> f64 {
        match self {
            Self::Deg => 2000.0,
            Self::Rad => 35.0,
        }
    }

    fn to_rad(self, angle: f64) -> f64 {
        match self {
            Self::Deg => angle.to_radians(),
            Self::Rad => angle,
        }
    }
}

impl fmt::Display for AngleUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Deg => "deg",
            Self::Rad => "rad",
        })
    }
}

/// The samples as read: at least [`MIN_SAMPLES`], times strictly increasing, everything finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// The times since the first row, in s; the first is 0.
    pub time_s: Vec<f64>,
    /// The angle at each time, in rad.
    pub angle_rad: Vec<f64>,
    /// Warnings about the recording.
    pub warnings: Vec<Warning>,
}

impl Samples {
    /// The time from the first sample to the last, in s.
    pub fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// The median of the intervals between the samples, in s; `None` below two samples.
    pub fn median_interval_s(&self) -> Option<f64> {
        let mut intervals: Vec<f64> = self
            .time_s
            .array_windows()
            .map(|[before, after]| after - before)
            .collect();
        if intervals.is_empty() {
            return None;
        }
        let middle = intervals.len() / 2;
        Some(*intervals.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Half the median sampling rate, in Hz: the limit for the cutoff of [`smooth`]. 0 below two
    /// samples.
    pub fn nyquist_hz(&self) -> f64 {
        self.median_interval_s()
            .map_or(0.0, |interval_s| 0.5 / interval_s)
    }
}

/// A column of something else than angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// The times since the first row, in s; the first is 0.
    pub time_s: Vec<f64>,
    /// The value at each time, as it is in the file.
    pub value: Vec<f64>,
    /// Warnings about the file.
    pub warnings: Vec<Warning>,
}

/// Reads a column of any unit, with its times.
///
/// # Errors
/// As [`read`], without what is said of angles.
pub fn read_values(path: &Path, time_column: &str, column: &str) -> Result<Values, RecordingError> {
    let samples = read(&Source {
        path,
        time_column,
        angle_column: column,
        unit: None,
    })?;
    Ok(Values {
        time_s: samples.time_s,
        value: samples.angle_rad,
        warnings: samples.warnings,
    })
}

/// Reads the two columns of `source`.
///
/// # Errors
/// Everything that keeps the file from being a motion, each with its place and what to do.
pub fn read(source: &Source<'_>) -> Result<Samples, RecordingError> {
    if source.time_column == source.angle_column {
        return Err(RecordingError::TimeIsAngle {
            place: Place::column_of(source, source.angle_column),
        });
    }
    let file = open(source.path)?;
    if is_opensim(source.path) {
        opensim_file::read(source, file)
    } else {
        csv_file::read(source, file)
    }
}

fn open(path: &Path) -> Result<File, RecordingError> {
    let unreadable = |io| RecordingError::Unreadable {
        place: Place::file(path),
        source: io,
    };
    let file = input::open(path).map_err(|error| match error {
        InputError::Kind(kind) => RecordingError::NotAFile {
            place: Place::file(path),
            kind,
        },
        error => unreadable(error.into()),
    })?;
    let bytes = file.metadata().map_err(unreadable)?.len();
    if bytes > MAX_BYTES {
        return Err(RecordingError::TooLarge {
            place: Place::file(path),
            bytes,
        });
    }
    Ok(file)
}

fn is_opensim(path: &Path) -> bool {
    path.extension().is_some_and(|extension| {
        extension.eq_ignore_ascii_case("mot") || extension.eq_ignore_ascii_case("sto")
    })
}

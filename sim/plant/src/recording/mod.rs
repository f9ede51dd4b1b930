//! A recorded knee motion, read from a file and made a C² function of time.
//!
//! ```text
//! a table ─ read ─> Samples ─ smooth ─> one cubic per interval: φ, Ω, Ω̇ continuous
//!                   s, rad
//! ```
//! [`read`] takes two columns of a table, CSV or OpenSim's, which is recognised by its content, and
//! validates them: an impossible motion is an error that names the file, line and column; an unusual
//! one is a warning. Every angle that is read passes one plausibility check. [`smooth`] is a zero-phase
//! low-pass and an interpolation in one. Both are needed: a recording carries noise that
//! differentiating amplifies, and a jump of Ω̇ is a jump of torque under the `physical` convention.
//! [`smooth_cycle`] makes a motion without end of one recorded cycle.

mod cyclic_bands;
mod error;
mod plausible;
mod repeat;
mod rows;
mod smooth;
mod smoothing_spline;
mod unit;

#[cfg(test)]
mod test_cells;
#[cfg(test)]
mod test_data;
#[cfg(test)]
mod test_plausible;
#[cfg(test)]
mod test_read;
#[cfg(test)]
mod test_repeat;
#[cfg(test)]
mod test_smooth;

pub use error::{Place, RecordingError};
pub use plausible::{JOINT_DEG, JOINT_DEG_S};
pub use repeat::{MAX_JOIN_DEG, smooth_cycle};
pub use smooth::{CubicSegment, acceleration_ripple_rad_s2, smooth};
pub use unit::{AngleUnit, TimeUnit};

use crepitus_files::input::{self, InputError};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The fewest samples that make a motion: a cubic has four coefficients.
pub const MIN_SAMPLES: usize = 4;

/// The most rows that are read, 28 hours at 200 Hz: two columns of them fill 320 MB.
pub const MAX_ROWS: usize = 20_000_000;

/// The largest file that is read, in bytes.
pub const MAX_BYTES: u64 = 2 << 30;

/// Location of the motion in the file, and how it is meant.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// The file.
    pub path: &'a Path,
    /// The name of the column with the times, or its position as `#1`.
    pub time_column: &'a str,
    /// The name of the column with the joint angle, or its position as `#2`.
    pub angle_column: &'a str,
    /// Quantity of that column.
    pub quantity: Quantity,
    /// The unit of the times; that of the file's row of units if left out, else seconds.
    pub time_unit: Option<TimeUnit>,
    /// The longest time without a number that is bridged, in s; 0 for none.
    pub max_gap_s: f64,
}

impl<'a> Source<'a> {
    /// A column of a quantity over times in seconds, without gaps.
    pub const fn new(
        path: &'a Path,
        time_column: &'a str,
        angle_column: &'a str,
        quantity: Quantity,
    ) -> Self {
        Self {
            path,
            time_column,
            angle_column,
            quantity,
            time_unit: None,
            max_gap_s: 0.0,
        }
    }
}

/// Quantity of a column.
#[derive(Debug, Clone, Copy)]
pub enum Quantity {
    /// Numbers of any unit, taken as they are.
    Number,
    /// Angles of a joint.
    Angles(Angles),
}

/// Angles of a joint in a file, and what becomes of them: factor · (angle in the file) +
/// `offset_deg`. The plausibility check is of the result; the samples are those of the file.
#[derive(Debug, Clone, Copy)]
pub struct Angles {
    /// The unit; that of the file if left out.
    pub unit: Option<AngleUnit>,
    /// Takes the unit of the file's header before `unit`, unless the numbers speak against it.
    pub yields_to_header: bool,
    /// Factor.
    pub factor: f64,
    /// Offset, in deg.
    pub offset_deg: f64,
}

impl Angles {
    /// Angles as they are in the file.
    pub const fn of(unit: Option<AngleUnit>) -> Self {
        Self {
            unit,
            yields_to_header: false,
            factor: 1.0,
            offset_deg: 0.0,
        }
    }
}

/// The samples as read: at least [`MIN_SAMPLES`], times strictly increasing, everything finite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples {
    /// The times since the first row, in s; the first is 0.
    pub time_s: Vec<f64>,
    /// The angle at each time, in rad; of another quantity the numbers as they are.
    pub angle_rad: Vec<f64>,
    /// The time of the first row as the file counts it, in s.
    pub first_s: f64,
    /// Warnings about the recording.
    pub warnings: Vec<String>,
    /// The unit that the angles have in the file.
    pub unit: Option<AngleUnit>,
    /// The unit that the header of an OpenSim file names.
    pub header_unit: Option<AngleUnit>,
    /// Assumptions about the form of the file, a sentence each.
    pub read_as: Vec<String>,
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
    read_from(source, open(source.path)?)
}

/// Reads the two columns of `source` from the bytes of its file.
///
/// # Errors
/// As [`read`].
pub fn read_from(source: &Source<'_>, bytes: impl Read) -> Result<Samples, RecordingError> {
    rows::read(source, bytes)
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

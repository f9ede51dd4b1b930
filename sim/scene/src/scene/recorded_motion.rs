//! The keys of `[motion]` with `kind = "recording"`: those of a file, or the samples themselves, `time_s` and `angle_rad`, which
//! are read as a file of them would be.
//!
//! ```text
//! file ─ read ─> samples ─ smooth ─> segments ─ · sign · scale, + offset ─> motion
//! ```
//! The spline is linear, so turning and stretching its segments is the same as doing so to the
//! samples; `sign` alone changes no bit but the sign's.

use super::data_file::DataFile;
use super::plausible_angles::ANY_DEG;
use crate::document::{Range, Section, Value};
use crate::error::SceneError;
use crepitus_plant::Motion;
use crepitus_plant::recording::{
    self, AngleUnit, Angles, MIN_SAMPLES, Quantity, RecordingError, Samples, Source, TimeUnit,
};
use std::fmt::Write;
use std::path::PathBuf;

/// Half-amplitude frequency of the low-pass over a recording, Hz: the 6 Hz
/// that gait laboratories use (Winter).
const DEFAULT_CUTOFF_HZ: f64 = 6.0;

/// Factors that a joint's angle could need.
const SCALE: Range = Range::above(0.0, 100.0);

/// Longest gap that could be bridged, s.
const GAP_S: Range = Range::closed(0.0, 10.0);

/// The motion of a recording, the largest change of its acceleration, and its
/// file, if it has one.
pub(super) fn recording(
    section: &Section<'_>,
    duration_s: f64,
    warnings: &mut Vec<String>,
) -> Result<(Motion, f64, Option<DataFile>), SceneError> {
    let given = Given::of(section)?;
    let cutoff_hz = section.number_or("cutoff_hz", Range::above(0.0, 1e6), DEFAULT_CUTOFF_HZ)?;
    let sign = sign(section)?;
    let scale = section.number_or("scale", SCALE, 1.0)?;
    let offset_deg = section.number_or("offset_deg", ANY_DEG, 0.0)?;
    let repeat = section.flag("repeat")?;
    let angles = Angles {
        factor: sign * scale,
        offset_deg,
        ..Angles::of(given.unit())
    };
    let samples = given.read(section, angles)?;
    if let (None, Some(taken)) = (given.unit(), samples.unit) {
        section.note("unit", Value::Text(taken.to_string()));
    }
    warnings.extend(samples.warnings.iter().cloned());
    // A duration written with fewer digits than the file's last time is meant.
    if !repeat && duration_s > samples.duration_s() * (1.0 + 1e-9) {
        return Err(section.key_error(
            given.key(),
            format!(
                "the recording lasts {} s, duration_s is {duration_s}: a scene cannot be longer than its recording, \
                 unless the recording is whole cycles and repeat = true",
                samples.duration_s()
            ),
        ));
    }
    let smooth = if repeat {
        recording::smooth_cycle
    } else {
        recording::smooth
    };
    let mut segments = smooth(&samples, cutoff_hz).map_err(|e| {
        let key = match e {
            RecordingError::NoCycle { .. } | RecordingError::ShortCycle { .. } => "repeat",
            _ => "cutoff_hz",
        };
        section.key_error(key, e.to_string())
    })?;
    for segment in &mut segments {
        *segment = segment.scaled(sign * scale);
    }
    let ripple = recording::acceleration_ripple_rad_s2(&segments);
    let data = given.data(section, &samples)?;
    let motion = if repeat {
        Motion::repeated(&segments)
    } else {
        Motion::recording(&segments)
    };
    Ok((motion.shifted(offset_deg.to_radians()), ripple, data))
}

/// Keys of samples in the scene itself.
const TIME: &str = "time_s";
const ANGLE: &str = "angle_rad";

/// Samples of a recording, as a scene has them.
enum Given<'a> {
    /// Columns of a file.
    File {
        path: PathBuf,
        time_column: &'a str,
        angle_column: &'a str,
        unit: Option<AngleUnit>,
        time_unit: Option<TimeUnit>,
        max_gap_s: f64,
    },
    /// Times, s, and angles, rad.
    Here {
        time_s: Vec<f64>,
        angle_rad: Vec<f64>,
    },
}

impl<'a> Given<'a> {
    fn of(section: &Section<'a>) -> Result<Self, SceneError> {
        let time_s = section.optional_numbers(TIME)?;
        let angle_rad = section.optional_numbers(ANGLE)?;
        let (time_s, angle_rad) = match (time_s, angle_rad) {
            (Some(time_s), Some(angle_rad)) => (time_s, angle_rad),
            (Some(_), None) => return Err(section.key_error(ANGLE, "the angles are missing, rad")),
            (None, Some(_)) => return Err(section.key_error(TIME, "the times are missing, s")),
            (None, None) => return Self::of_file(section),
        };
        if section.has("file") {
            let message = "give a file, or the samples with time_s and angle_rad, not both";
            return Err(section.key_error("file", message));
        }
        check(section, &time_s, &angle_rad)?;
        Ok(Self::Here { time_s, angle_rad })
    }

    fn of_file(section: &Section<'a>) -> Result<Self, SceneError> {
        let file = section.text("file")?;
        let units = [("deg", AngleUnit::Deg), ("rad", AngleUnit::Rad)];
        Ok(Self::File {
            path: section.file().parent().unwrap_or(section.file()).join(file),
            time_column: section.text("time_column")?,
            angle_column: section.text("angle_column")?,
            unit: section.optional_choice("unit", &units)?,
            time_unit: section.optional_choice("time_unit", &TimeUnit::ALL)?,
            max_gap_s: section.optional_number("max_gap_s", GAP_S)?.unwrap_or(0.0),
        })
    }

    /// The key that an error of the whole recording names.
    const fn key(&self) -> &'static str {
        match self {
            Self::File { .. } => "file",
            Self::Here { .. } => TIME,
        }
    }

    const fn unit(&self) -> Option<AngleUnit> {
        match self {
            Self::File { unit, .. } => *unit,
            Self::Here { .. } => Some(AngleUnit::Rad),
        }
    }

    fn read(&self, section: &Section<'_>, angles: Angles) -> Result<Samples, SceneError> {
        let quantity = Quantity::Angles(angles);
        let samples = match self {
            Self::File {
                path,
                time_column,
                angle_column,
                time_unit,
                max_gap_s,
                ..
            } => recording::read(&Source {
                time_unit: *time_unit,
                max_gap_s: *max_gap_s,
                ..Source::new(path, time_column, angle_column, quantity)
            }),
            Self::Here { time_s, angle_rad } => {
                let mut table = format!("{TIME},{ANGLE}\n");
                for (time_s, angle_rad) in time_s.iter().zip(angle_rad) {
                    let _ = writeln!(table, "{time_s:?},{angle_rad:?}");
                }
                let source = Source::new(section.file(), TIME, ANGLE, quantity);
                recording::read_from(&source, table.as_bytes())
            }
        };
        samples.map_err(|e| {
            let key = match (self, &e) {
                (Self::Here { .. }, _) => ANGLE,
                (_, RecordingError::NoUnit { .. }) => "unit",
                (_, RecordingError::NotAClock { .. }) => "time_unit",
                (_, RecordingError::LongGap { .. }) => "max_gap_s",
                _ => "file",
            };
            section.key_error(key, e.to_string())
        })
    }

    /// The file, as it was read.
    fn data(
        &self,
        section: &Section<'_>,
        samples: &Samples,
    ) -> Result<Option<DataFile>, SceneError> {
        let Self::File { path, .. } = self else {
            return Ok(None);
        };
        let mut data = DataFile::of(path)
            .map_err(|e| section.key_error("file", format!("cannot be read: {e}")))?;
        data.read_as.clone_from(&samples.read_as);
        // JSON has no other names.
        let Some(whole_path) = data.file.to_str() else {
            return Err(section.key_error(
                "file",
                format!(
                    "{}: expected a path in UTF-8, because the run's summary.json names it: rename the file or its folder",
                    data.file.display()
                ),
            ));
        };
        // A program that repeats the run finds it from anywhere.
        section.note("file", Value::Text(whole_path.to_owned()));
        Ok(Some(data))
    }
}

/// Checks samples, and names the one that is wrong.
fn check(section: &Section<'_>, time_s: &[f64], angle_rad: &[f64]) -> Result<(), SceneError> {
    let refuse = |key: &str, message: String| Err(section.key_error(key, message));
    let (times, angles) = (time_s.len(), angle_rad.len());
    if times != angles {
        return refuse(
            ANGLE,
            format!("expected as many angles as times, {times}, got {angles}"),
        );
    }
    if times < MIN_SAMPLES {
        return refuse(
            TIME,
            format!("expected at least {MIN_SAMPLES} samples, got {times}"),
        );
    }
    for (key, numbers) in [(TIME, time_s), (ANGLE, angle_rad)] {
        if let Some(n) = numbers.iter().position(|x| !x.is_finite()) {
            let x = numbers[n];
            return refuse(
                key,
                format!("[{n}]: expected a finite number, got {x}: leave such samples out of both"),
            );
        }
    }
    if let Some(n) = time_s.array_windows().position(|[a, b]| a >= b) {
        let (before, after) = (time_s[n], time_s[n + 1]);
        return refuse(
            TIME,
            format!(
                "[{}]: expected a time after {before} s, got {after} s: sort the samples by time, and leave repeats out",
                n + 1
            ),
        );
    }
    Ok(())
}

/// 1 or −1.
fn sign(section: &Section<'_>) -> Result<f64, SceneError> {
    let sign = section.number_or("sign", Range::closed(-1.0, 1.0), 1.0)?;
    if sign.abs() == 1.0 {
        return Ok(sign);
    }
    Err(section.key_error(
        "sign",
        format!("{sign} is not allowed: 1, or -1 where the file counts flexion as negative; scale stretches"),
    ))
}

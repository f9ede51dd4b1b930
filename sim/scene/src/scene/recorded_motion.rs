//! The keys of `[motion]` with `kind = "recording"`.
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
    self, AngleUnit, Angles, Quantity, RecordingError, Source, TimeUnit,
};

/// Half-amplitude frequency of the low-pass over a recording, Hz: the 6 Hz
/// that gait laboratories use (Winter).
const DEFAULT_CUTOFF_HZ: f64 = 6.0;

/// Factors that a joint's angle could need.
const SCALE: Range = Range::above(0.0, 100.0);

/// Longest gap that could be bridged, s.
const GAP_S: Range = Range::closed(0.0, 10.0);

/// The motion of a recording, the largest change of its acceleration, and its
/// file.
pub(super) fn recording(
    section: &Section<'_>,
    duration_s: f64,
    warnings: &mut Vec<String>,
) -> Result<(Motion, f64, DataFile), SceneError> {
    let file = section.text("file")?;
    let time_column = section.text("time_column")?;
    let angle_column = section.text("angle_column")?;
    let units = [("deg", AngleUnit::Deg), ("rad", AngleUnit::Rad)];
    let unit = section.optional_choice("unit", &units)?;
    let time_unit = section.optional_choice("time_unit", &TimeUnit::ALL)?;
    let max_gap_s = section.optional_number("max_gap_s", GAP_S)?;
    let cutoff_hz = section.number_or("cutoff_hz", Range::above(0.0, 1e6), DEFAULT_CUTOFF_HZ)?;
    let sign = sign(section)?;
    let scale = section.number_or("scale", SCALE, 1.0)?;
    let offset_deg = section.number_or("offset_deg", ANY_DEG, 0.0)?;
    let repeat = section.flag("repeat")?;
    let folder = section.file().parent().unwrap_or(section.file());
    let path = folder.join(file);
    let angles = Angles {
        factor: sign * scale,
        offset_deg,
        ..Angles::of(unit)
    };
    let source = Source {
        time_unit,
        max_gap_s: max_gap_s.unwrap_or(0.0),
        ..Source::new(&path, time_column, angle_column, Quantity::Angles(angles))
    };
    let samples = recording::read(&source).map_err(|e| {
        let key = match e {
            RecordingError::NoUnit { .. } => "unit",
            RecordingError::NotAClock { .. } => "time_unit",
            RecordingError::LongGap { .. } => "max_gap_s",
            _ => "file",
        };
        section.key_error(key, e.to_string())
    })?;
    if let (None, Some(taken)) = (unit, samples.unit) {
        section.note("unit", Value::Text(taken.to_string()));
    }
    warnings.extend(samples.warnings.iter().cloned());
    // A duration written with fewer digits than the file's last time is meant.
    if !repeat && duration_s > samples.duration_s() * (1.0 + 1e-9) {
        return Err(section.key_error(
            "file",
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
    let mut data = DataFile::of(&path)
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
    let motion = if repeat {
        Motion::repeated(&segments)
    } else {
        Motion::recording(&segments)
    };
    Ok((motion.shifted(offset_deg.to_radians()), ripple, data))
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

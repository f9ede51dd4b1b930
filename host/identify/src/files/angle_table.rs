//! Angles, torques and currents in tables of others: dynamometers, goniometers, a laboratory's own.

use super::columns::Columns;
use super::{FileError, refused};
use crepitus_plant::recording::{
    self, AngleUnit, Angles, Quantity, RecordingError, Samples, Source, TimeUnit,
};
use std::path::Path;

/// Names of columns in such files, the likelier ones first, in small letters and without their unit.
const TIMES: &[&str] = &["t", "time", "times", "elapsed time", "timestamp", "zeit"];
const ANGLES: &[&str] = &[
    "angle",
    "knee angle",
    "knee flexion",
    "knee flexion angle",
    "flexion",
    "position",
    "knee angle r",
    "knee angle l",
    "joint angle",
    "anatomical position",
    "pos",
    "winkel",
    "kniewinkel",
];

/// Columns of time and angle in a table. Names that are left out are found; errors name what to give as the
/// program's options.
#[derive(Clone, Debug)]
pub struct AngleColumns {
    /// Column of the times, a name or #1.
    pub time: Option<String>,
    /// Unit of the times: `s`, `ms`, `us`, `min` or `clock`; that of the file, else s, if it is left out.
    pub time_unit: Option<String>,
    /// Column of the angles.
    pub angle: Option<String>,
    /// Unit of the angles; that of the file or of the column's name, else deg, if it is left out.
    pub unit: Option<AngleUnit>,
    /// Factor of the angles, -1 where they count extension.
    pub angle_scale: f64,
    /// Addend of the angles after the factor, deg.
    pub angle_offset_deg: f64,
}

impl Default for AngleColumns {
    fn default() -> Self {
        Self {
            time: None,
            time_unit: None,
            angle: None,
            unit: None,
            angle_scale: 1.0,
            angle_offset_deg: 0.0,
        }
    }
}

/// Times, s, and angles, rad, of a table.
#[derive(Debug)]
pub(super) struct TableAngles {
    /// Column of the times, and their unit.
    time: String,
    time_unit: Option<TimeUnit>,
    pub(super) time_s: Vec<f64>,
    pub(super) angle_rad: Vec<f64>,
}

impl AngleColumns {
    /// Rejects impossible factors.
    pub(super) fn check(&self) -> Result<(), FileError> {
        factor("--angle-scale", self.angle_scale)?;
        if self.angle_offset_deg.is_finite() {
            Ok(())
        } else {
            Err(refused("--angle-offset: expected degrees"))
        }
    }

    /// Reads time and angle.
    pub(super) fn angles(
        &self,
        file: &Path,
        columns: &Columns,
        warn: &mut dyn FnMut(&str),
    ) -> Result<TableAngles, FileError> {
        let given = self.time_unit()?;
        let time = columns.find(self.time.as_deref(), TIMES, ("times", "--time"))?;
        let angle = columns.find(self.angle.as_deref(), ANGLES, ("angles", "--angle"))?;
        // A row of units is read with the rows.
        let of_name = TimeUnit::of_word(&time.unit);
        let time_unit = given.or(of_name);
        let angles = |unit| {
            Quantity::Angles(Angles {
                yields_to_header: self.unit.is_none(),
                factor: self.angle_scale,
                offset_deg: self.angle_offset_deg,
                ..Angles::of(unit)
            })
        };
        let samples = match read(file, &time.name, time_unit, &angle.name, angles(self.unit)) {
            Err(RecordingError::NoUnit { .. }) => {
                let deg = angles(Some(AngleUnit::Deg));
                read(file, &time.name, time_unit, &angle.name, deg)
            }
            read => read,
        };
        let samples = samples.map_err(refused)?;
        samples
            .read_as
            .iter()
            .chain(&samples.warnings)
            .for_each(|warning| warn(warning));
        let offset_rad = self.angle_offset_deg.to_radians();
        Ok(TableAngles {
            time: time.name,
            time_unit,
            time_s: samples.time_s,
            angle_rad: samples
                .angle_rad
                .iter()
                .map(|x| self.angle_scale * x + offset_rad)
                .collect(),
        })
    }

    fn time_unit(&self) -> Result<Option<TimeUnit>, FileError> {
        let Some(name) = &self.time_unit else {
            return Ok(None);
        };
        let known = TimeUnit::ALL.iter().find(|(known, _)| known == name);
        known.map(|(_, unit)| Some(*unit)).ok_or_else(|| {
            refused(format!(
                "--time-unit: expected s, ms, us, min or clock, got `{name}`"
            ))
        })
    }
}

impl TableAngles {
    /// Reads the numbers of a column in the rows of the angles.
    pub(super) fn numbers(
        &self,
        file: &Path,
        column: &str,
        what: &str,
    ) -> Result<Vec<f64>, FileError> {
        let samples = read(file, &self.time, self.time_unit, column, Quantity::Number);
        let samples = samples.map_err(refused)?;
        if samples.time_s.len() == self.time_s.len() {
            return Ok(samples.angle_rad);
        }
        Err(refused(format!(
            "{}: {} rows have an angle and {} have a {what}: leave out the rows without",
            file.display(),
            self.time_s.len(),
            samples.time_s.len()
        )))
    }
}

/// Rejects a factor that is none.
pub(super) fn factor(option: &str, value: f64) -> Result<(), FileError> {
    if value.is_finite() && value != 0.0 {
        return Ok(());
    }
    Err(refused(format!(
        "{option}: expected a number other than 0, got {value}"
    )))
}

fn read(
    file: &Path,
    time: &str,
    time_unit: Option<TimeUnit>,
    column: &str,
    quantity: Quantity,
) -> Result<Samples, RecordingError> {
    recording::read(&Source {
        time_unit,
        ..Source::new(file, time, column, quantity)
    })
}

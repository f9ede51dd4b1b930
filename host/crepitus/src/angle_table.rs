//! Angles, torques and currents in tables of others: dynamometers, goniometers, a laboratory's own.

use crate::failure::{Failure, warn};
use clap::{Args, ValueEnum};
use crepitus_plant::recording::{
    self, AngleUnit, Angles, Quantity, RecordingError, Samples, Source, TimeUnit,
};
use std::path::Path;

/// Names that columns have in such files, the likelier ones first.
const TIMES: &[&str] = &[
    "t_s",
    "time",
    "Time",
    "time_s",
    "Time (s)",
    "TIME",
    "t",
    "Time (ms)",
];
const ANGLES: &[(&str, Option<AngleUnit>)] = &[
    ("angle_rad", Some(AngleUnit::Rad)),
    ("angle_deg", Some(AngleUnit::Deg)),
    ("angle", None),
    ("Angle", None),
    ("position", None),
    ("Position", None),
    ("POSITION", None),
    ("knee_angle", None),
    ("knee_angle_r", None),
    ("knee_angle_l", None),
    ("knee_flexion", None),
    ("Position (deg)", Some(AngleUnit::Deg)),
    ("Angle (deg)", Some(AngleUnit::Deg)),
];

/// Columns of time and angle in a table.
#[derive(Debug, Args)]
pub(crate) struct AngleTable {
    /// Column of the times, a name or #1 [default: t_s, time or the like].
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,

    /// Unit of the times: s, ms, us, min or clock [default: that of the file, else s].
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,

    /// Column of the angles [default: angle_rad, angle_deg, angle, position or the like].
    #[arg(long, value_name = "COLUMN")]
    pub(crate) angle: Option<String>,

    /// Unit of the angles [default: that of the file or of the column's name, else deg].
    #[arg(long, value_name = "UNIT")]
    unit: Option<Unit>,

    /// Factor of the angles, -1 where they count extension.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    pub(crate) angle_scale: f64,

    /// Added to the angles after the factor, deg.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub(crate) angle_offset: f64,
}

/// Unit of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Unit {
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
}

/// Times, s, and angles, rad, of a table.
#[derive(Debug)]
pub(crate) struct TableAngles<'t> {
    /// Column of the times.
    time: &'t str,
    pub(crate) time_s: Vec<f64>,
    pub(crate) angle_rad: Vec<f64>,
}

impl AngleTable {
    /// Rejects impossible factors.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        factor("--angle-scale", self.angle_scale)?;
        if self.angle_offset.is_finite() {
            Ok(())
        } else {
            Err(Failure::input("--angle-offset: expected degrees"))
        }
    }

    /// Reads time and angle.
    pub(crate) fn angles(&self, file: &Path) -> Result<TableAngles<'_>, Failure> {
        let unit = self.unit.map(|unit| match unit {
            Unit::Deg => AngleUnit::Deg,
            Unit::Rad => AngleUnit::Rad,
        });
        let times: Vec<&str> = self
            .time
            .as_deref()
            .map_or_else(|| TIMES.to_vec(), |name| vec![name]);
        let named: Vec<(&str, Option<AngleUnit>)> = self
            .angle
            .as_deref()
            .map_or_else(|| ANGLES.to_vec(), |name| vec![(name, None)]);
        let angles = |of_name: Option<AngleUnit>| {
            Quantity::Angles(Angles {
                yields_to_header: unit.is_none(),
                factor: self.angle_scale,
                offset_deg: self.angle_offset,
                ..Angles::of(Some(unit.or(of_name).unwrap_or(AngleUnit::Deg)))
            })
        };
        let time_unit = self.time_unit()?;
        let columns = times.iter().flat_map(|time| {
            named
                .iter()
                .map(move |(column, unit)| (*time, *column, *unit))
        });
        let (time, samples) = first(
            columns.map(|(time, column, of_name)| {
                (time, read(file, time, time_unit, column, angles(of_name)))
            }),
            "time and angle",
            "--time and --angle",
        )?;
        samples
            .read_as
            .iter()
            .chain(&samples.warnings)
            .for_each(warn);
        let offset_rad = self.angle_offset.to_radians();
        Ok(TableAngles {
            time,
            time_s: samples.time_s,
            angle_rad: samples
                .angle_rad
                .iter()
                .map(|x| self.angle_scale * x + offset_rad)
                .collect(),
        })
    }

    /// Reads the numbers of the first of these columns, in the rows of the angles.
    pub(crate) fn numbers(
        &self,
        file: &Path,
        angles: &TableAngles<'_>,
        columns: &[&str],
        (what, options): (&str, &str),
    ) -> Result<Vec<f64>, Failure> {
        let time_unit = self.time_unit()?;
        let reads = columns.iter().map(|column| {
            (
                angles.time,
                read(file, angles.time, time_unit, column, Quantity::Number),
            )
        });
        let (_, samples) = first(reads, what, options)?;
        if samples.time_s.len() == angles.time_s.len() {
            return Ok(samples.angle_rad);
        }
        Err(Failure::Input(format!(
            "{}: {} rows have an angle and {} have {what}: leave out the rows without",
            file.display(),
            angles.time_s.len(),
            samples.time_s.len()
        )))
    }

    fn time_unit(&self) -> Result<Option<TimeUnit>, Failure> {
        let Some(name) = &self.time_unit else {
            return Ok(None);
        };
        let known = TimeUnit::ALL.iter().find(|(known, _)| known == name);
        known.map(|(_, unit)| Some(*unit)).ok_or_else(|| {
            Failure::Input(format!(
                "--time-unit: expected s, ms, us, min or clock, got `{name}`"
            ))
        })
    }
}

/// Rejects a factor that is none.
pub(crate) fn factor(option: &str, value: f64) -> Result<(), Failure> {
    if value.is_finite() && value != 0.0 {
        return Ok(());
    }
    Err(Failure::Input(format!(
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

/// Returns the first column that the file has.
fn first<'t>(
    reads: impl Iterator<Item = (&'t str, Result<Samples, RecordingError>)>,
    what: &str,
    options: &str,
) -> Result<(&'t str, Samples), Failure> {
    let mut missing = None;
    for (time, read) in reads {
        match read {
            Ok(samples) => return Ok((time, samples)),
            Err(error @ RecordingError::MissingColumn { .. }) => {
                missing.get_or_insert(error);
            }
            Err(error) => return Err(Failure::input(error)),
        }
    }
    let why = missing.map_or_else(String::new, |error| format!(" ({error})"));
    Err(Failure::Input(format!(
        "no column of {what} was found: name it with {options}{why}"
    )))
}

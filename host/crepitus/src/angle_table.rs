//! Options for angles in tables of others: dynamometers, goniometers, a laboratory's own.

use clap::{Args, ValueEnum};
use crepitus_identify::files::AngleColumns;
use crepitus_plant::recording::AngleUnit;

/// Columns of time and angle in a table.
#[derive(Debug, Args)]
pub(crate) struct AngleTable {
    /// Column of the times, a name or #1 [default: t, time or the like].
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,

    /// Unit of the times: s, ms, us, min or clock [default: that of the file or of the column's name, else s].
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,

    /// Column of the angles [default: angle, knee flexion, position or the like].
    #[arg(long, value_name = "COLUMN")]
    angle: Option<String>,

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
    angle_scale: f64,

    /// Added to the angles after the factor, deg.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    angle_offset: f64,
}

/// Unit of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Unit {
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
}

impl AngleTable {
    /// Returns the columns.
    pub(crate) fn columns(&self) -> AngleColumns {
        AngleColumns {
            time: self.time.clone(),
            time_unit: self.time_unit.clone(),
            angle: self.angle.clone(),
            unit: self.unit.map(|unit| match unit {
                Unit::Deg => AngleUnit::Deg,
                Unit::Rad => AngleUnit::Rad,
            }),
            angle_scale: self.angle_scale,
            angle_offset_deg: self.angle_offset,
        }
    }
}

//! `--overlay`: measured curves over those of a report.

use crate::cli::key_and_value;
use crate::failure::{Failure, warn};
use clap::Args;
use crepitus_files::table::list;
use crepitus_pages::report::{Difference, Measured, Quantity};
use crepitus_plant::recording::{self, AngleUnit, Angles, RecordingError, Samples, Source};
use crepitus_scene::trace::Column;
use std::path::{Path, PathBuf};

/// The name of the times, in a trace and in a mapping.
const TIME: &str = "t_s";

/// Names of curves in a mapping: those of a trace, and angles in degrees. With the unit of an angle.
const NAMES: [(&str, Quantity, Option<AngleUnit>); 7] = [
    ("angle_rad", Quantity::Angle, Some(AngleUnit::Rad)),
    ("angle_deg", Quantity::Angle, Some(AngleUnit::Deg)),
    ("omega_rad_s", Quantity::Velocity, Some(AngleUnit::Rad)),
    ("omega_deg_s", Quantity::Velocity, Some(AngleUnit::Deg)),
    ("torque_nm", Quantity::Torque, None),
    ("hand_torque_nm", Quantity::HandTorque, None),
    ("motor_torque_nm", Quantity::MotorTorque, None),
];

/// Measured curves, and how to read them.
#[derive(Debug, Default, Args)]
pub(crate) struct Overlay {
    /// Lay measured curves over those of the run: a table such as CSV, or OpenSim's .mot or .sto, whose header
    /// names the unit of angles.
    #[arg(id = "overlay", long = "overlay", value_name = "FILE")]
    file: Option<PathBuf>,

    /// Columns of that file by ours: t_s, angle_rad or angle_deg, omega_rad_s or omega_deg_s, torque_nm,
    /// hand_torque_nm, motor_torque_nm [default: those with these names]. THEIRS is a name, in quotes if it has a
    /// comma (torque_nm="T, N·m"), or a position (torque_nm=#4).
    #[arg(
        id = "overlay-columns",
        long = "overlay-columns",
        value_name = "OURS=THEIRS",
        requires = "overlay"
    )]
    columns: Vec<String>,

    /// A factor of a column, -1 where it counts the other way round.
    #[arg(id = "overlay-scale", long = "overlay-scale", value_name = "OURS=FACTOR", value_delimiter = ',', value_parser = key_and_value, requires = "overlay",
          allow_hyphen_values = true)]
    scales: Vec<(String, String)>,

    /// Offset of a column, added after the factor, in the unit of its name.
    #[arg(id = "overlay-offset", long = "overlay-offset", value_name = "OURS=VALUE", value_delimiter = ',', value_parser = key_and_value, requires = "overlay")]
    offsets: Vec<(String, String)>,

    /// When the first row of the file was, in the time of the run, s.
    #[arg(
        id = "overlay-shift",
        long = "overlay-shift",
        value_name = "SECONDS",
        default_value_t = 0.0,
        requires = "overlay",
        allow_negative_numbers = true
    )]
    shift_s: f64,
}

impl Overlay {
    /// The measured curves, read before the work; none without `--overlay`. `columns` are those of
    /// the trace.
    pub(crate) fn read(&self, columns: &[Column]) -> Result<Vec<Measured>, Failure> {
        let Some(file) = &self.file else {
            return Ok(Vec::new());
        };
        if !self.shift_s.is_finite() {
            return Err(Failure::Input(
                "--overlay-shift: expected seconds".to_owned(),
            ));
        }
        let mapped = mapping(&self.columns)?;
        let scales = numbers("--overlay-scale", &self.scales)?;
        let offsets = numbers("--overlay-offset", &self.offsets)?;
        let time = mapped.iter().find(|(name, _)| name == TIME);
        let time = time.map_or(TIME, |(_, column)| column.as_str());
        let named = mapped.iter().filter(|(name, _)| name != TIME);
        let wanted: Vec<(&str, &str)> = if named.clone().count() > 0 {
            named
                .map(|(ours, theirs)| (ours.as_str(), theirs.as_str()))
                .collect()
        } else {
            NAMES.iter().map(|(name, ..)| (*name, *name)).collect()
        };
        let is_mapped = mapped.iter().any(|(name, _)| name != TIME);
        let mut measured: Vec<Measured> = Vec::new();
        let mut first_s = None;
        let mut notes: Vec<String> = Vec::new();
        let mut said = |note: &str| {
            if !notes.iter().any(|known| known == note) {
                warn(format!("{}: {note}", file.display()));
                notes.push(note.to_owned());
            }
        };
        let mut missing = None;
        for (ours, theirs) in wanted {
            let Some((_, quantity, unit)) = NAMES.iter().find(|(name, ..)| *name == ours) else {
                return Err(unknown("--overlay-columns", ours));
            };
            let of = |list: &[(String, f64)], or: f64| {
                list.iter()
                    .find(|(name, _)| name == ours)
                    .map_or(or, |(_, x)| *x)
            };
            let (scale, offset) = (of(&scales, 1.0), of(&offsets, 0.0));
            let in_file = match (quantity, unit) {
                (Quantity::Angle, Some(unit)) => recording::Quantity::Angles(Angles {
                    yields_to_header: true,
                    factor: scale,
                    offset_deg: in_deg(*unit, offset),
                    ..Angles::of(Some(*unit))
                }),
                _ => recording::Quantity::Number,
            };
            let values = match recording::read(&Source::new(file, time, theirs, in_file)) {
                Ok(values) => values,
                // Without a mapping: what the file has.
                Err(
                    error @ RecordingError::MissingColumn {
                        role: "column" | "angle_column",
                        ..
                    },
                ) if !is_mapped => {
                    missing = Some(error);
                    continue;
                }
                Err(error) => return Err(failed(&error)),
            };
            if measured.iter().any(|other| other.quantity == *quantity) {
                return Err(Failure::Input(format!(
                    "--overlay: {ours} is named a second time, in another unit: name one of them with --overlay-columns"
                )));
            }
            check(*quantity, ours, columns)?;
            values.read_as.iter().for_each(|note| said(note));
            values.warnings.iter().for_each(warn);
            first_s = Some(values.first_s);
            measured.push(Measured {
                quantity: *quantity,
                value: in_trace(*quantity, *unit, &values, (scale, offset)),
                time_s: values.time_s.iter().map(|t| t + self.shift_s).collect(),
            });
        }
        if let Some(first_s) = first_s.filter(|first_s| *first_s != self.shift_s) {
            said(&format!(
                "the times begin at {first_s} s, which is laid at {} s of the run (--overlay-shift)",
                self.shift_s
            ));
        }
        match (measured.is_empty(), missing) {
            (true, Some(error)) => Err(failed(&error)),
            _ => Ok(measured),
        }
    }

    /// The file.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }
}

fn failed(error: &RecordingError) -> Failure {
    let hint = match error {
        RecordingError::MissingColumn { .. } => {
            "; name the columns as in --overlay-columns t_s=time,torque_nm=T"
        }
        _ => "",
    };
    Failure::Input(format!("--overlay: {error}{hint}"))
}

fn unknown(option: &str, name: &str) -> Failure {
    let names: Vec<&str> = NAMES.iter().map(|(name, ..)| *name).collect();
    Failure::Input(format!(
        "{option}: there is no curve {name}: the names and units are {TIME}, {}",
        names.join(", ")
    ))
}

fn mapping(columns: &[String]) -> Result<Vec<(String, String)>, Failure> {
    let refused = |reason: String| Failure::Input(format!("--overlay-columns: {reason}"));
    let mut mapped: Vec<(String, String)> = Vec::new();
    for part in columns {
        for pair in list(part).map_err(refused)? {
            let (name, column) = key_and_value(&pair).map_err(refused)?;
            if mapped.iter().any(|(other, _)| *other == name) {
                return Err(refused(format!("{name} is named twice")));
            }
            mapped.push((name, column));
        }
    }
    Ok(mapped)
}

fn in_deg(unit: AngleUnit, angle: f64) -> f64 {
    match unit {
        AngleUnit::Deg => angle,
        AngleUnit::Rad => angle.to_degrees(),
    }
}

/// The values in the unit of a trace: factor and offset are in the unit of our name.
fn in_trace(
    quantity: Quantity,
    unit: Option<AngleUnit>,
    samples: &Samples,
    (scale, offset): (f64, f64),
) -> Vec<f64> {
    const PER_DEG: f64 = std::f64::consts::PI / 180.0;
    let to_rad = |unit| match unit {
        Some(AngleUnit::Deg) => PER_DEG,
        _ => 1.0,
    };
    let (named, values) = (to_rad(unit), samples.angle_rad.iter());
    match quantity {
        // In rad already.
        Quantity::Angle => values.map(|x| scale * x + named * offset).collect(),
        Quantity::Velocity => {
            // A table of speeds has the unit of its angles.
            let in_file = to_rad(samples.header_unit.or(unit));
            if in_file != named {
                warn(
                    "--overlay: the header's inDegrees names another unit than the column's name; the header counts",
                );
            }
            values
                .map(|x| in_file * scale * x + named * offset)
                .collect()
        }
        _ => values.map(|x| scale * x + offset).collect(),
    }
}

fn numbers(option: &str, list: &[(String, String)]) -> Result<Vec<(String, f64)>, Failure> {
    list.iter()
        .map(|(name, text)| {
            if !NAMES.iter().any(|(known, ..)| known == name) {
                return Err(unknown(option, name));
            }
            match text.parse::<f64>() {
                Ok(x) if x.is_finite() && !(option == "--overlay-scale" && x == 0.0) => {
                    Ok((name.clone(), x))
                }
                _ => Err(Failure::Input(format!(
                    "{option}: {name}={text}: expected a number{}",
                    if option == "--overlay-scale" {
                        " other than 0"
                    } else {
                        ""
                    }
                ))),
            }
        })
        .collect()
}

/// A curve that the run has, too.
fn check(quantity: Quantity, ours: &str, columns: &[Column]) -> Result<(), Failure> {
    let name = quantity.column();
    if columns.iter().any(|column| column.name == name) {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "--overlay: {ours} has nothing to lie over: the run has no {name} (a hand, a motor or crepitus is not among its \
         effects)"
    )))
}

/// A line for each measured curve.
pub(crate) fn in_brief(differences: &[Difference]) -> String {
    differences.iter().fold(String::new(), |text, d| {
        let known = |x: Option<f64>| x.map_or_else(|| "not known".to_owned(), |x| format!("{x:.5}"));
        text + &format!(
            "  measured {}: {} samples compared, {} outside the run; RMS difference {}, correlation {}\n",
            d.column,
            d.points,
            d.outside,
            known(d.rms_difference),
            known(d.correlation)
        )
    })
}

/// Says which curves have no sample within the run.
pub(crate) fn warn_of_nothing(differences: &[Difference], file: Option<&Path>) {
    for d in differences.iter().filter(|d| d.points == 0) {
        let file = file.map_or_else(String::new, |file| format!("{}: ", file.display()));
        warn(format!(
            "{file}no time of the measured {} lies within the run: shift it with --overlay-shift",
            d.column
        ));
    }
}

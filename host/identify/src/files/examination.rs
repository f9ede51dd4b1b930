//! Angle and torque of a file, in rad and N·m.

use super::angle_table::{AngleColumns, factor};
use super::columns::{Column, Columns};
use super::{FileError, above_zero, refused};
use crate::knee::Examination;
use crepitus_recording::{Damage, ReadError, Recording};
use std::fmt;
use std::path::Path;

/// Names of the torque in files, the likelier ones first, in small letters and without their unit.
const TORQUES: &[&str] = &[
    "hand torque",
    "torque",
    "knee torque",
    "moment",
    "knee moment",
    "joint torque",
    "drehmoment",
];

/// Angle and torque in a file. Errors name what to give as the program's options.
#[derive(Clone, Debug)]
pub struct ExaminationColumns {
    /// Columns of time and angle.
    pub table: AngleColumns,
    /// Column of the torque; found by its name if it is left out.
    pub torque: Option<String>,
    /// Unit of the torque; that of the file or of the column's name, else N·m, if it is left out.
    pub torque_unit: Option<TorqueUnit>,
    /// Factor of the torque, -1 where it is positive against extension, or the lever in m of a force in N.
    pub torque_scale: f64,
    /// Inertia of a leg that was let go of and swings freely, kg·m²: no torque is read.
    pub released_kg_m2: Option<f64>,
}

/// Unit of a torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TorqueUnit {
    /// N·m.
    Nm,
    /// Foot-pounds.
    FtLb,
    /// Inch-pounds.
    InLb,
}

impl TorqueUnit {
    /// Every unit, with the name that a person gives.
    pub const ALL: [(&str, Self); 3] = [
        ("nm", Self::Nm),
        ("ft-lb", Self::FtLb),
        ("in-lb", Self::InLb),
    ];

    /// Returns the unit of this name.
    pub fn find(name: &str) -> Option<Self> {
        let known = Self::ALL.iter().find(|(known, _)| *known == name);
        known.map(|(_, unit)| *unit)
    }

    /// N·m of one of it (NIST SP 811, B.8).
    const fn nm(self) -> f64 {
        match self {
            Self::Nm => 1.0,
            Self::FtLb => 1.355_817_948,
            Self::InLb => 0.112_984_829,
        }
    }
}

impl fmt::Display for TorqueUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nm => "N·m",
            Self::FtLb => "ft-lb",
            Self::InLb => "in-lb",
        })
    }
}

/// Reads an examination from a recording of a device, or from a table.
///
/// # Errors
/// [`FileError`] that says what is missing.
pub fn read_examination(
    file: &Path,
    columns: &ExaminationColumns,
    warn: &mut dyn FnMut(&str),
) -> Result<Examination, FileError> {
    columns.table.check()?;
    factor("--torque-scale", columns.torque_scale)?;
    let released = columns.released_kg_m2;
    if let Some(inertia) = released {
        above_zero("--released-kg-m2", inertia)?;
    }
    match Recording::open(file, Damage::Refuse) {
        Ok(recording) => of_recording(&recording, columns, released),
        Err(ReadError::Foreign(_)) => of_table(file, columns, released, warn),
        Err(error) => Err(refused(error)),
    }
}

/// A recording of a device: its angle, and the torque that it showed.
fn of_recording(
    recording: &Recording,
    columns: &ExaminationColumns,
    released_kg_m2: Option<f64>,
) -> Result<Examination, FileError> {
    /// Ticks between two samples that are kept: 1 ms.
    const EVERY: u64 = 20;
    let table = &columns.table;
    if table.time.is_some() || table.angle.is_some() || columns.torque.is_some() {
        return Err(refused(
            "a recording has its own angle and torque: --time, --angle and --torque are for tables",
        ));
    }
    let mut examination = Examination {
        released_kg_m2,
        ..Examination::default()
    };
    for row in recording.rows().map_err(refused)? {
        let row = row.map_err(refused)?;
        if row.tick.is_multiple_of(EVERY) {
            examination.time_s.push(row.time_s);
            examination
                .angle_rad
                .push(table.angle_scale * row.angle_rad + table.angle_offset_deg.to_radians());
            examination
                .torque_nm
                .push(columns.torque_scale * f64::from(row.torque_nm));
        }
    }
    Ok(examination)
}

fn of_table(
    file: &Path,
    columns: &ExaminationColumns,
    released_kg_m2: Option<f64>,
    warn: &mut dyn FnMut(&str),
) -> Result<Examination, FileError> {
    let named = Columns::of(file)?;
    let angles = columns.table.angles(file, &named, warn)?;
    let mut torque_nm = Vec::new();
    if released_kg_m2.is_none() {
        let options = "--torque, or give --released-kg-m2 of a leg that swings freely";
        let column = named.find(columns.torque.as_deref(), TORQUES, ("torques", options))?;
        torque_nm = angles.numbers(file, &column.name, "torque")?;
        let nm = columns.torque_scale * unit(columns, &column, warn)?.nm();
        for torque in &mut torque_nm {
            *torque *= nm;
        }
    }
    Ok(Examination {
        time_s: angles.time_s,
        angle_rad: angles.angle_rad,
        torque_nm,
        released_kg_m2,
    })
}

/// Returns the unit that a person or the file states.
fn unit(
    columns: &ExaminationColumns,
    column: &Column,
    warn: &mut dyn FnMut(&str),
) -> Result<TorqueUnit, FileError> {
    let of_file = match column.unit.as_str() {
        "" | "nm" | "newtonmeter" | "newtonmeters" | "newtonmetres" => Some(TorqueUnit::Nm),
        "ftlb" | "ftlbs" | "ftlbf" | "lbft" | "lbfft" | "footpounds" => Some(TorqueUnit::FtLb),
        "inlb" | "inlbs" | "inlbf" | "lbin" | "lbfin" | "inchpounds" => Some(TorqueUnit::InLb),
        // A force at a known lever.
        "n" | "newton" | "newtons" if (columns.torque_scale.abs() - 1.0).abs() > 1e-9 => {
            Some(TorqueUnit::Nm)
        }
        _ => None,
    };
    match (columns.torque_unit, of_file) {
        (Some(said), Some(of_file)) if said != of_file && !column.unit.is_empty() => {
            warn(&format!(
                "column \"{}\": the file says {}; taken as {said}",
                column.name, column.unit
            ));
            Ok(said)
        }
        (Some(said), _) => Ok(said),
        (None, Some(of_file)) => {
            if of_file != TorqueUnit::Nm {
                warn(&format!("torques are in {of_file}, as the file says"));
            }
            Ok(of_file)
        }
        (None, None) => Err(refused(format!(
            "column \"{}\": its unit \"{}\" is none of a torque that is known: name one with --torque-unit; of a force \
             in N give the lever in m with --torque-scale",
            column.name, column.unit
        ))),
    }
}

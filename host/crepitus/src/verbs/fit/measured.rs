//! Angle and torque of a file, in rad and N·m.

use super::Arguments;
use crate::angle_table::factor;
use crate::cli::above_zero;
use crate::failure::Failure;
use crepitus_identify::knee::Examination;
use crepitus_recording::{Damage, ReadError, Recording};

/// Names that the torque has in files, the likelier ones first.
const TORQUES: &[&str] = &[
    "hand_torque_nm",
    "torque_nm",
    "torque",
    "Torque",
    "TORQUE",
    "moment",
    "Moment",
    "knee_moment",
    "Torque (Nm)",
    "Torque (N-M)",
];

/// Reads the examination.
pub(super) fn read(arguments: &Arguments) -> Result<Examination, Failure> {
    arguments.table.check()?;
    factor("--torque-scale", arguments.torque_scale)?;
    let released = arguments
        .released_kg_m2
        .map(|value| above_zero("--released-kg-m2", value));
    let released = released.transpose()?;
    match Recording::open(&arguments.file, Damage::Refuse) {
        Ok(recording) => of_recording(&recording, arguments, released),
        Err(ReadError::Foreign(_)) => of_table(arguments, released),
        Err(error) => Err(Failure::input(error)),
    }
}

/// What a device has recorded: its angle, and the torque that it showed.
fn of_recording(
    recording: &Recording,
    arguments: &Arguments,
    released_kg_m2: Option<f64>,
) -> Result<Examination, Failure> {
    /// Ticks between two samples that are kept: 1 ms.
    const EVERY: u64 = 20;
    let table = &arguments.table;
    if table.time.is_some() || table.angle.is_some() || arguments.torque.is_some() {
        return Err(Failure::input(
            "a recording has its own angle and torque: --time, --angle and --torque are for tables",
        ));
    }
    let mut examination = Examination {
        released_kg_m2,
        ..Examination::default()
    };
    for row in recording.rows().map_err(Failure::input)? {
        let row = row.map_err(Failure::input)?;
        if row.tick.is_multiple_of(EVERY) {
            examination.time_s.push(row.time_s);
            examination
                .angle_rad
                .push(table.angle_scale * row.angle_rad + table.angle_offset.to_radians());
            examination
                .torque_nm
                .push(arguments.torque_scale * f64::from(row.torque_nm));
        }
    }
    Ok(examination)
}

fn of_table(arguments: &Arguments, released_kg_m2: Option<f64>) -> Result<Examination, Failure> {
    let (file, table) = (&arguments.file, &arguments.table);
    let angles = table.angles(file)?;
    let mut torque_nm = Vec::new();
    if released_kg_m2.is_none() {
        let columns: Vec<&str> = arguments
            .torque
            .as_deref()
            .map_or_else(|| TORQUES.to_vec(), |name| vec![name]);
        let words = (
            "torque",
            "--torque, or give --released-kg-m2 of a leg that swings freely",
        );
        torque_nm = table.numbers(file, &angles, &columns, words)?;
        let nm = arguments.torque_scale * arguments.torque_unit.nm();
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

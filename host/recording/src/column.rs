//! The columns of a recording, once: name, meaning, type, and how a row has it.
//!
//! CSV, JSON, Parquet, MCAP and Python follow from this table. A new column is a line here and a field of
//! [`Row`], which [`Samples`](crate::Samples) fills.

use crate::row::Row;
use serde_json::{Map, Number, Value};
use std::fmt::Write as _;

/// A column.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// The name; its unit is part of it.
    pub name: &'static str,
    /// Meaning.
    pub about: &'static str,
    /// Type of its cells, and how a row has them.
    pub cell: Cell,
    /// Whether a summary of several rows has the lowest, the mean and the highest of it.
    pub is_ranged: bool,
}

/// Type of a column's cells: how to get it from a row, and how to set it there.
#[derive(Clone, Copy, Debug)]
pub enum Cell {
    /// A count that does not wrap.
    U64(fn(&Row) -> u64, fn(&mut Row, u64)),
    /// A number without a sign.
    U32(fn(&Row) -> u32, fn(&mut Row, u32)),
    /// A number with a sign.
    I32(fn(&Row) -> i32, fn(&mut Row, i32)),
    /// A number in double precision.
    F64(fn(&Row) -> f64, fn(&mut Row, f64)),
    /// A number in single precision.
    F32(fn(&Row) -> f32, fn(&mut Row, f32)),
    /// A number that a row need not have.
    Measured(fn(&Row) -> Option<f32>, fn(&mut Row, f32)),
    /// A word; all words of a row come from its flags and phases, and are read back together.
    Word(fn(&Row, &mut String)),
}

impl Column {
    const fn new(name: &'static str, about: &'static str, cell: Cell) -> Self {
        Self {
            name,
            about,
            cell,
            is_ranged: false,
        }
    }

    const fn ranged(name: &'static str, about: &'static str, cell: Cell) -> Self {
        Self {
            is_ranged: true,
            ..Self::new(name, about, cell)
        }
    }

    /// Appends the cell of a row as text; numbers read back to the same bits.
    pub fn append(&self, row: &Row, line: &mut String) {
        let mut numbers = ryu::Buffer::new();
        // Writing to a string does not fail.
        match self.cell {
            Cell::U64(get, _) => drop(write!(line, "{}", get(row))),
            Cell::U32(get, _) => drop(write!(line, "{}", get(row))),
            Cell::I32(get, _) => drop(write!(line, "{}", get(row))),
            Cell::F64(get, _) => line.push_str(numbers.format(get(row))),
            Cell::F32(get, _) => line.push_str(numbers.format(get(row))),
            Cell::Measured(get, _) => {
                if let Some(value) = get(row) {
                    line.push_str(numbers.format(value));
                }
            }
            Cell::Word(append) => append(row, line),
        }
    }
}

/// All columns, in their order.
pub const COLUMNS: [Column; 14] = [
    Column::new(
        "tick",
        "ticks of 50 µs since the drive has started",
        Cell::U64(|row| row.tick, |row, tick| row.tick = tick),
    ),
    Column::new(
        "t_s",
        "time since the first recorded tick, s",
        Cell::F64(|row| row.time_s, |row, time_s| row.time_s = time_s),
    ),
    Column::new(
        "count",
        "counts of the encoder since the angle's zero",
        Cell::I32(|row| row.count, |row, count| row.count = count),
    ),
    Column::new(
        "angle_rad",
        "angle of the joint, rad; grows with flexion",
        Cell::F64(|row| row.angle_rad, |row, rad| row.angle_rad = rad),
    ),
    Column::new(
        "omega_rad_s",
        "estimated velocity of the joint, rad/s: the drive's own estimator",
        Cell::F32(|row| row.omega_rad_s, |row, rad_s| row.omega_rad_s = rad_s),
    ),
    Column::new(
        "phase",
        "of the imaginary object: stick, slip+, slip-",
        Cell::Word(|row, line| line.push_str(row.phase())),
    ),
    Column::new(
        "event",
        "what happened in the tick: break, stick, or both",
        Cell::Word(|row, line| line.push_str(row.event())),
    ),
    Column::ranged(
        "model_torque_nm",
        "torque of the model, N·m; positive opposes growing angle",
        Cell::F32(
            |row| row.model_torque_nm,
            |row, nm| row.model_torque_nm = nm,
        ),
    ),
    Column::ranged(
        "torque_nm",
        "torque commanded to the motor, N·m",
        Cell::F32(|row| row.torque_nm, |row, nm| row.torque_nm = nm),
    ),
    Column::ranged(
        "current_a",
        "measured current, A; positive drives towards growing angle; empty if it was not measured",
        Cell::Measured(|row| row.current_a, |row, a| row.current_a = Some(a)),
    ),
    Column::ranged(
        "coil_current_a",
        "measured current of the vibration actuator's coil, A: the mean of five ticks, the same in each of them; \
         empty while it is not driven",
        Cell::Measured(|row| row.coil_a, |row, a| row.coil_a = Some(a)),
    ),
    Column::new(
        "revision",
        "of the parameters in force",
        Cell::U32(|row| row.revision, |row, revision| row.revision = revision),
    ),
    Column::new(
        "limit",
        "why the torque is not the model's: none, torque, slew, current, voltage, turned-back, holding, not-armed, range, tank",
        Cell::Word(|row, line| line.push_str(row.flags.limit().name())),
    ),
    Column::new(
        "notes",
        "settling: parameters are ramping; lost: count rejected; late: rendering was late; tank:N: eighths of the torque of clonus and reflex that the tank holds back; \
         EFFECT:PHASE: an effect that is not at rest",
        Cell::Word(Row::append_notes),
    ),
];

impl Row {
    /// Appends it as a line of CSV; numbers read back to the same bits.
    pub fn append_to(&self, line: &mut String) {
        let mut separator = "";
        for column in &COLUMNS {
            line.push_str(separator);
            column.append(self, line);
            separator = ",";
        }
        line.push('\n');
    }

    /// Returns the row as an object, with the names of [`COLUMNS`] and the same numbers; what
    /// is empty in a line is null.
    pub fn to_json(&self) -> Value {
        let value = |column: &Column| {
            let mut text = String::new();
            column.append(self, &mut text);
            let number = text.parse::<Number>().ok();
            match column.cell {
                _ if text.is_empty() => Value::Null,
                Cell::Word(_) => Value::String(text),
                // What is not finite is no number of JSON.
                _ => number.map_or(Value::String(text), Value::Number),
            }
        };
        let members = COLUMNS
            .iter()
            .map(|column| (column.name.to_owned(), value(column)));
        members.collect::<Map<_, _>>().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::telemetry::SampleFlags;

    #[test]
    fn an_object_has_the_names_and_numbers_of_a_line() {
        let row = Row {
            tick: 1 << 40,
            time_s: 0.1,
            omega_rad_s: 0.1,
            flags: SampleFlags::default()
                .with(SampleFlags::BREAK, true)
                .with(SampleFlags::LOST, true),
            ..Row::default()
        };
        let object = row.to_json();
        let mut line = String::new();
        row.append_to(&mut line);
        for (Column { name, .. }, cell) in COLUMNS.iter().zip(line.trim_end().split(',')) {
            let text = match &object[name] {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                number => number.to_string(),
            };
            assert_eq!(text, cell, "{name}");
        }
        assert_eq!(object.as_object().unwrap().len(), COLUMNS.len());
        assert_eq!(
            (&object["event"], &object["notes"]),
            (&"break".into(), &"lost".into())
        );
        assert!(object["current_a"].is_null() && object["omega_rad_s"] == 0.1);
    }
}

//! A sample as a line of CSV.

use crepitus_model::render::effects::Phases;
use crepitus_protocol::LimitReason;
use crepitus_protocol::telemetry::SampleFlags;
use serde_json::{Map, Number, Value};
use std::fmt::Write as _;

/// The columns, with what they mean.
pub const COLUMNS: [(&str, &str); 13] = [
    ("tick", "ticks of 50 µs since the drive has started"),
    ("t_s", "time since the first recorded tick, s"),
    ("count", "counts of the encoder since the angle's zero"),
    ("angle_rad", "angle of the joint, rad; grows with flexion"),
    (
        "omega_rad_s",
        "estimated velocity of the joint, rad/s: the drive's own estimator",
    ),
    ("phase", "of the imaginary object: stick, slip+, slip-"),
    ("event", "what happened in the tick: break, stick, or both"),
    (
        "model_torque_nm",
        "torque of the model, N·m; positive opposes growing angle",
    ),
    ("torque_nm", "torque commanded to the motor, N·m"),
    (
        "current_a",
        "measured current, A; positive drives towards growing angle; empty if it was not measured",
    ),
    ("revision", "of the parameters in force"),
    (
        "limit",
        "why the torque is not the model's: none, torque, slew, current, voltage, turned-back, holding, not-armed",
    ),
    (
        "notes",
        "settling: parameters are ramping; lost: count rejected; late: rendering was late; EFFECT:PHASE: an effect that is not at rest",
    ),
];

/// A sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Ticks since the drive has started.
    pub tick: u64,
    /// Time since the first recorded tick, s.
    pub time_s: f64,
    /// Counts of the encoder.
    pub count: i32,
    /// Angle of the joint, rad.
    pub angle_rad: f64,
    /// Velocity of the joint, rad/s.
    pub omega_rad_s: f32,
    /// Torque of the model, N·m.
    pub model_torque_nm: f32,
    /// Torque commanded to the motor, N·m.
    pub torque_nm: f32,
    /// Measured current, A.
    pub current_a: Option<f32>,
    /// Of the parameters in force.
    pub revision: u32,
    /// Phase, limit and the rest.
    pub flags: SampleFlags,
}

/// An invalid cell of a line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {column}: invalid value {text:?}")]
pub struct RowError {
    /// The column.
    pub column: &'static str,
    /// Its text.
    pub text: String,
}

/// The columns of text; the others are numbers.
const WORDS: [&str; 4] = ["phase", "event", "limit", "notes"];

/// Names of the notes.
const NOTES: [(u16, &str); 3] = [
    (SampleFlags::SETTLING, "settling"),
    (SampleFlags::LOST, "lost"),
    (SampleFlags::LATE, "late"),
];

impl Row {
    /// Appends it as a line; numbers read back to the same bits.
    pub fn append_to(&self, line: &mut String) {
        let mut numbers = ryu::Buffer::new();
        // Writing to a string does not fail.
        let _ = write!(line, "{},", self.tick);
        line.push_str(numbers.format(self.time_s));
        let _ = write!(line, ",{},", self.count);
        line.push_str(numbers.format(self.angle_rad));
        line.push(',');
        line.push_str(numbers.format(self.omega_rad_s));
        line.push_str(match self.flags.phase_sign() {
            0 => ",stick,",
            1.. => ",slip+,",
            _ => ",slip-,",
        });
        line.push_str(
            match (
                self.flags.has(SampleFlags::BREAK),
                self.flags.has(SampleFlags::STICK),
            ) {
                (false, false) => ",",
                (true, false) => "break,",
                (false, true) => "stick,",
                (true, true) => "both,",
            },
        );
        line.push_str(numbers.format(self.model_torque_nm));
        line.push(',');
        line.push_str(numbers.format(self.torque_nm));
        line.push(',');
        if let Some(current_a) = self.current_a {
            line.push_str(numbers.format(current_a));
        }
        let _ = write!(line, ",{},{},", self.revision, self.flags.limit().name());
        let mut separator = "";
        for (bit, name) in NOTES {
            if self.flags.has(bit) {
                line.push_str(separator);
                line.push_str(name);
                separator = "+";
            }
        }
        for (effect, phase) in self.flags.phases().named() {
            let _ = write!(line, "{separator}{}:{phase}", effect.name);
            separator = "+";
        }
        line.push('\n');
    }

    /// As an object, with the names of [`COLUMNS`] and the same numbers; what
    /// is empty in a line is null.
    pub fn to_json(&self) -> Value {
        let mut line = String::new();
        self.append_to(&mut line);
        let cells = COLUMNS.iter().zip(line.trim_end().split(','));
        let value = |(name, _): &(&str, &str), text: &str| match text.parse::<Number>() {
            Ok(number) if !WORDS.contains(name) => Value::Number(number),
            _ if text.is_empty() => Value::Null,
            _ => Value::String(text.to_owned()),
        };
        cells
            .map(|(column, text)| (column.0.to_owned(), value(column, text)))
            .collect::<Map<_, _>>()
            .into()
    }

    /// Parses a line without its newline.
    ///
    /// # Errors
    /// [`RowError`] for the first invalid cell.
    pub fn parse(line: &str) -> Result<Self, RowError> {
        let mut cells = line.split(',');
        let mut columns = COLUMNS.iter();
        let mut next = || {
            let column = columns.next().map_or("?", |(name, _)| *name);
            (column, cells.next().unwrap_or(""))
        };
        let tick = number(next())?;
        let time_s = number(next())?;
        let count = number(next())?;
        let angle_rad = number(next())?;
        let omega_rad_s = number(next())?;
        let phase = next();
        let event = next();
        let row = Self {
            tick,
            time_s,
            count,
            angle_rad,
            omega_rad_s,
            model_torque_nm: number(next())?,
            torque_nm: number(next())?,
            current_a: match next() {
                (_, "") => None,
                cell => Some(number(cell)?),
            },
            revision: number(next())?,
            flags: flags(phase, event, next(), next())?,
        };
        match cells.next() {
            None => Ok(row),
            Some(text) => Err(wrong(("notes", text))),
        }
    }
}

type Cell<'a> = (&'static str, &'a str);

fn wrong((column, text): Cell<'_>) -> RowError {
    RowError {
        column,
        text: text.to_owned(),
    }
}

fn number<T: std::str::FromStr>(cell: Cell<'_>) -> Result<T, RowError> {
    cell.1.parse().map_err(|_| wrong(cell))
}

fn flags(
    phase: Cell<'_>,
    event: Cell<'_>,
    limit: Cell<'_>,
    set: Cell<'_>,
) -> Result<SampleFlags, RowError> {
    let sign = match phase.1 {
        "stick" => 0,
        "slip+" => 1,
        "slip-" => -1,
        _ => return Err(wrong(phase)),
    };
    let (breaks, sticks) = match event.1 {
        "" => (false, false),
        "break" => (true, false),
        "stick" => (false, true),
        "both" => (true, true),
        _ => return Err(wrong(event)),
    };
    let reason = LimitReason::ALL
        .into_iter()
        .find(|reason| reason.name() == limit.1)
        .ok_or_else(|| wrong(limit))?;
    let mut flags = SampleFlags::default()
        .with_phase(sign)
        .with(SampleFlags::BREAK, breaks)
        .with(SampleFlags::STICK, sticks)
        .with(SampleFlags::ENERGISED, reason != LimitReason::NotArmed)
        .with_limit(reason);
    for name in set.1.split('+').filter(|name| !name.is_empty()) {
        flags = match name.split_once(':') {
            Some((effect, phase)) => Phases::default()
                .with_named(effect, phase)
                .map(|phases| flags.with_phases(phases)),
            None => NOTES
                .iter()
                .find(|(_, known)| *known == name)
                .map(|(bit, _)| flags.with(*bit, true)),
        }
        .ok_or_else(|| wrong(set))?;
    }
    Ok(flags)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Row> {
        let plain = Row {
            tick: u64::MAX,
            time_s: 0.1 + 0.2,
            count: i32::MIN,
            angle_rad: -1.0 / 3.0,
            omega_rad_s: 1.0e-30,
            model_torque_nm: 0.1,
            torque_nm: -0.2,
            current_a: Some(0.3),
            revision: 7,
            flags: SampleFlags::default().with_limit(LimitReason::NotArmed),
        };
        let mut rows = vec![
            plain,
            Row {
                current_a: None,
                ..plain
            },
        ];
        for reason in LimitReason::ALL {
            for bits in [
                0,
                SampleFlags::SETTLING | SampleFlags::LATE,
                SampleFlags::LOST | SampleFlags::BREAK,
                SampleFlags::BREAK | SampleFlags::STICK,
            ] {
                let flags = SampleFlags(bits)
                    .with_phase(-1)
                    .with(SampleFlags::ENERGISED, reason != LimitReason::NotArmed)
                    .with_limit(reason);
                rows.push(Row { flags, ..plain });
            }
        }
        rows
    }

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
        for ((name, _), cell) in COLUMNS.iter().zip(line.trim_end().split(',')) {
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

    #[test]
    fn a_row_reads_back_to_the_same_bits() {
        for row in rows() {
            let mut line = String::new();
            row.append_to(&mut line);
            assert_eq!(line.matches(',').count() + 1, COLUMNS.len());
            assert_eq!(Row::parse(line.trim_end_matches('\n')), Ok(row), "{line}");
        }
    }

    #[test]
    fn a_phase_of_an_effect_that_there_is_not_is_refused() {
        let mut line = String::new();
        rows()[0].append_to(&mut line);
        for notes in [
            "no-effect:contact",
            "bone-shaping:contact",
            "bone-shaping:",
            ":",
        ] {
            let wrong = Row::parse(&format!("{}{notes}", line.trim_end())).unwrap_err();
            assert_eq!((wrong.column, wrong.text.as_str()), ("notes", notes));
        }
    }

    #[test]
    fn a_wrong_cell_is_named() {
        let mut line = String::new();
        rows()[0].append_to(&mut line);
        let cells: Vec<_> = line.trim_end().split(',').collect();
        for (i, (column, _)) in COLUMNS.iter().enumerate() {
            let mut broken = cells.clone();
            broken[i] = "?";
            assert_eq!(Row::parse(&broken.join(",")).unwrap_err().column, *column);
            // Cut off in the middle.
            if i < 12 {
                assert!(Row::parse(&cells[..i].join(",")).is_err());
            }
        }
    }
}

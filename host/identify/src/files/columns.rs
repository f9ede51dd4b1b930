//! Columns of a table by what they are usually called, with the units that the file states.

use crate::files::{FileError, refused};
use crepitus_files::input;
use crepitus_files::table::{Names, Table};
use std::path::Path;

/// Words at the end of a name that are a unit.
const UNITS: &[&str] = &[
    "s", "sec", "seconds", "ms", "msec", "us", "min", "deg", "degree", "degrees", "rad", "radians",
    "nm", "n", "m", "ft", "foot", "in", "inch", "lb", "lbs", "lbf", "pounds",
];

/// A column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::files) struct Column {
    /// Name, or position as `#1`.
    pub(in crate::files) name: String,
    /// Unit in small letters and without signs, by the row of units or by the name; empty if nothing says it.
    pub(in crate::files) unit: String,
}

/// Names and units of a table's columns.
pub(in crate::files) struct Columns(Vec<Column>);

impl Columns {
    /// Reads the head of a table.
    pub(in crate::files) fn of(file: &Path) -> Result<Self, FileError> {
        let place = file.display();
        let opened = input::open(file).map_err(|e| refused(format!("{place}: {e}")))?;
        let table = Table::open(opened, Names::Holding(&[]))
            .map_err(|e| refused(format!("{place}: {e}")))?;
        let column = |(at, name): (usize, &String)| Column {
            unit: (table.unit(at)).map_or_else(|| split(name).1, |unit| letters(&unit)),
            name: name.clone(),
        };
        Ok(Self(table.names().iter().enumerate().map(column).collect()))
    }

    /// Returns the column that a person has named, or the first that is called one of these.
    pub(in crate::files) fn find(
        &self,
        named: Option<&str>,
        usual: &[&str],
        (what, options): (&str, &str),
    ) -> Result<Column, FileError> {
        let unknown = |name: &str| Column {
            name: name.to_owned(),
            unit: String::new(),
        };
        if let Some(name) = named {
            let known = self.0.iter().find(|column| column.name == name);
            // A name that the file does not have is an error of the reader, with what it has.
            return Ok(known.cloned().unwrap_or_else(|| unknown(name)));
        }
        let called = |usual: &&str| {
            self.0
                .iter()
                .find(|column| split(&column.name).0 == **usual)
        };
        usual.iter().find_map(called).cloned().ok_or_else(|| {
            let names: Vec<&str> = self.0.iter().map(|column| column.name.as_str()).collect();
            refused(format!(
                "no column of {what} was found: name it with {options}; the file has {}",
                names.join(", ")
            ))
        })
    }
}

/// Returns the words of a name without its unit, and the unit.
fn split(name: &str) -> (String, String) {
    let name = name.to_lowercase();
    let (before, in_brackets) = match name.split_once(['(', '[']) {
        Some((before, rest)) => (before, letters(rest.split([')', ']']).next().unwrap_or(""))),
        None => (name.as_str(), String::new()),
    };
    let words: Vec<&str> = before
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let is_unit = |word: &&&str| UNITS.contains(*word);
    let behind = words.iter().skip(1).rev().take_while(is_unit).count();
    let (words, unit) = words.split_at(words.len() - behind);
    let unit = if in_brackets.is_empty() {
        unit.concat()
    } else {
        in_brackets
    };
    (words.join(" "), unit)
}

/// Letters of a unit: `N·m`, `N-M` and `Nm` are one.
fn letters(unit: &str) -> String {
    unit.to_lowercase()
        .chars()
        .filter(|c| c.is_alphabetic() || *c == '°')
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_from_their_units() {
        for (name, words, unit) in [
            ("t_s", "t", "s"),
            ("Time (ms)", "time", "ms"),
            ("angle_rad", "angle", "rad"),
            ("KNEE_FLEXION_DEG", "knee flexion", "deg"),
            ("Torque (N-M)", "torque", "nm"),
            ("Torque [ft·lb]", "torque", "ftlb"),
            ("hand_torque_nm", "hand torque", "nm"),
            ("Moment N.m", "moment", "nm"),
            ("POS (ANAT)", "pos", "anat"),
            ("Angle (°)", "angle", "°"),
            ("m", "m", ""),
            ("", "", ""),
        ] {
            assert_eq!(split(name), (words.to_owned(), unit.to_owned()), "{name}");
        }
    }
}

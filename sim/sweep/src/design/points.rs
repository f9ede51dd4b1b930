//! Points of another program from a CSV file with a key of the scene over each column.

use crepitus_files::input::{self, InputError};
use std::io;
use std::path::Path;

/// Table of points, one per row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Points {
    paths: Vec<String>,
    values: Vec<Vec<String>>,
}

/// Error of an invalid table of points.
#[derive(Debug, thiserror::Error)]
pub enum PointsError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    File(#[from] InputError),
    /// The file cannot be read as CSV; the line is in the cause.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    /// A column without a name, or one name twice.
    #[error(
        "line 1: column {column} has {what}: the first line has a key of the scene over each column"
    )]
    Header {
        /// Column, from 1.
        column: usize,
        /// Description of the mistake.
        what: String,
    },
    /// An empty cell.
    #[error("line {line}: `{path}` is empty")]
    Empty {
        /// Line, from 1.
        line: usize,
        /// The key.
        path: String,
    },
    /// There is only a header.
    #[error("there is no row of values below the header")]
    NoRows,
}

impl Points {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// [`PointsError`].
    pub fn read(file: &Path) -> Result<Self, PointsError> {
        Self::from_csv(input::read(file, input::TABLE_BYTES)?.as_slice())
    }

    /// Reads CSV.
    ///
    /// # Errors
    /// [`PointsError`].
    pub fn from_csv(text: impl io::Read) -> Result<Self, PointsError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text);
        let paths: Vec<_> = reader.headers()?.iter().map(str::to_owned).collect();
        let rows: Vec<Vec<String>> = reader
            .records()
            .map(|record| Ok(record?.iter().map(str::to_owned).collect()))
            .collect::<Result<_, csv::Error>>()?;
        Self::new(paths, rows)
    }

    /// Creates a table from rows of values, with a key per column.
    ///
    /// # Errors
    /// [`PointsError`].
    pub fn new(paths: Vec<String>, values: Vec<Vec<String>>) -> Result<Self, PointsError> {
        for (place, path) in paths.iter().enumerate() {
            let what = if path.is_empty() {
                "no name".to_owned()
            } else if paths[..place].contains(path) {
                format!("the name `{path}` for the second time")
            } else {
                continue;
            };
            return Err(PointsError::Header {
                column: place + 1,
                what,
            });
        }
        for (row, values) in values.iter().enumerate() {
            if let Some(place) = values.iter().position(String::is_empty) {
                return Err(PointsError::Empty {
                    line: row + 2,
                    path: paths.get(place).cloned().unwrap_or_default(),
                });
            }
        }
        if values.is_empty() {
            return Err(PointsError::NoRows);
        }
        Ok(Self { paths, values })
    }

    pub(super) const fn rows(&self) -> u64 {
        self.values.len() as u64
    }

    pub(super) fn paths(&self) -> Vec<&str> {
        self.paths.iter().map(String::as_str).collect()
    }

    pub(super) fn row(&self, number: u64) -> &[String] {
        let place = usize::try_from(number).unwrap_or(usize::MAX);
        self.values.get(place).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_a_point() {
        let points = Points::from_csv("a.b, c\n1.5, exact\n2,heun\n".as_bytes()).unwrap();
        assert_eq!(points.paths(), ["a.b", "c"]);
        assert_eq!(points.rows(), 2);
        assert_eq!(points.row(0), ["1.5", "exact"]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, word) in [
            (
                "a,a\n1,2\n",
                "column 2 has the name `a` for the second time",
            ),
            ("a,\n1,2\n", "column 2 has no name"),
            ("a,b\n1,2\n3,\n", "line 3: `b` is empty"),
            ("a,b\n1,2\n3\n", "line: 3"),
            ("a,b\n", "no row"),
        ] {
            let error = Points::from_csv(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(word), "{text:?}: {error}");
        }
    }
}

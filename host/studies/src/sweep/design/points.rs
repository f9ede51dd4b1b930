//! Points of another program from a table with a key of the scene over each column.

use crepitus_files::input::{self, InputError};
use crepitus_files::table::{Names, Table, TableError};
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
    /// The file cannot be read as a table.
    #[error("{0}")]
    Table(#[from] TableError),
    /// A column without a name, or one name twice.
    #[error(
        "line {line}: column {column} has {what}: the first line has a key of the scene over each column"
    )]
    Header {
        /// Line, from 1.
        line: u64,
        /// Column, from 1.
        column: usize,
        /// Description of the mistake.
        what: String,
    },
    /// An empty cell.
    #[error("line {line}: `{path}` is empty")]
    Empty {
        /// Line, from 1.
        line: u64,
        /// The key.
        path: String,
    },
    /// There is only a header.
    #[error("there is no row of values below the header")]
    NoRows,
}

impl Points {
    /// Reads a table: commas, semicolons or tabs between cells, and where no comma separates, decimal
    /// commas.
    ///
    /// # Errors
    /// [`PointsError`].
    pub fn read(file: &Path) -> Result<Self, PointsError> {
        Self::from_csv(input::read(file, input::TABLE_BYTES)?.as_slice())
    }

    /// Reads a table from its bytes.
    ///
    /// # Errors
    /// [`PointsError`].
    pub fn from_csv(text: impl io::Read) -> Result<Self, PointsError> {
        let mut table = Table::open(text, Names::FirstLine)?;
        let paths = table.names().to_vec();
        check(&paths, table.names_line())?;
        let mut values = Vec::new();
        while let Some(line) = table.advance()? {
            let row: Vec<String> = (0..paths.len()).map(|place| table.value(place)).collect();
            if let Some(place) = row.iter().position(String::is_empty) {
                return Err(PointsError::Empty {
                    line,
                    path: paths.get(place).cloned().unwrap_or_default(),
                });
            }
            values.push(row);
        }
        if values.is_empty() {
            return Err(PointsError::NoRows);
        }
        Ok(Self { paths, values })
    }

    /// Creates a table from rows of values, with a key per column.
    ///
    /// # Errors
    /// [`PointsError`].
    pub fn new(paths: Vec<String>, values: Vec<Vec<String>>) -> Result<Self, PointsError> {
        check(&paths, 1)?;
        for (row, values) in values.iter().enumerate() {
            if let Some(place) = values.iter().position(String::is_empty) {
                return Err(PointsError::Empty {
                    line: row as u64 + 2,
                    path: paths.get(place).cloned().unwrap_or_default(),
                });
            }
        }
        if values.is_empty() {
            return Err(PointsError::NoRows);
        }
        Ok(Self { paths, values })
    }

    /// Writes the table as CSV, which [`Self::from_written`] reads back to the same texts.
    ///
    /// # Errors
    /// Those of the writer.
    pub(crate) fn write(&self, to: impl io::Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(to);
        writer.write_record(&self.paths)?;
        for row in &self.values {
            writer.write_record(row)?;
        }
        writer.flush()
    }

    /// Reads a table that [`Self::write`] has written.
    ///
    /// # Errors
    /// Description of the error, if it is not one.
    pub(crate) fn from_written(from: impl io::Read) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(from);
        let texts = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let paths = texts(reader.headers().map_err(|e| e.to_string())?);
        let rows = reader.records().map(|row| row.map(|row| texts(&row)));
        let rows = rows.collect::<Result<Vec<Vec<_>>, _>>();
        Self::new(paths, rows.map_err(|e| e.to_string())?).map_err(|e| e.to_string())
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

/// Refuses a column without a name, and one name twice.
fn check(paths: &[String], line: u64) -> Result<(), PointsError> {
    for (place, path) in paths.iter().enumerate() {
        let what = if path.is_empty() {
            "no name".to_owned()
        } else if paths[..place].contains(path) {
            format!("the name `{path}` for the second time")
        } else {
            continue;
        };
        return Err(PointsError::Header {
            line,
            column: place + 1,
            what,
        });
    }
    Ok(())
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
    fn what_is_written_is_read_back() {
        let texts = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect();
        let rows = vec![texts(&["[1, 2]", " \"a\";\n"]), texts(&["1,5", "0.1"])];
        let points = Points::new(texts(&["a.b", "c"]), rows).unwrap();
        let mut written = Vec::new();
        points.write(&mut written).unwrap();
        assert_eq!(Points::from_written(written.as_slice()).unwrap(), points);
        assert!(Points::from_written("a,b\n1\n".as_bytes()).is_err());
    }

    #[test]
    fn semicolons_and_tabs_separate_and_numbers_may_have_decimal_commas() {
        for text in ["a.b;c\r\n1,5;x\r\n2;45\r\n", "a.b\tc\n1,5\tx\n2\t45\n"] {
            let points = Points::from_csv(text.as_bytes()).unwrap();
            assert_eq!(points.paths(), ["a.b", "c"]);
            assert_eq!(points.row(0), ["1.5", "x"]);
            assert_eq!(points.row(1), ["2", "45"]);
        }
        let one = Points::from_csv("a.b\n1.5\n2\n".as_bytes()).unwrap();
        assert_eq!((one.paths(), one.rows()), (vec!["a.b"], 2));
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
            ("a,b\n1,2\n3\n", "line 3: the file ends inside this row"),
            ("a,b\n1,2\n3\n4,5\n", "line 3: the row has 1 cells"),
            ("a,b\n1,\"x\n2,3\n", "line 2: a quote"),
            ("\u{1f}\0", "binary"),
            ("<html>", "web page"),
            ("a,b\n", "no row"),
        ] {
            let error = Points::from_csv(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(word), "{text:?}: {error}");
        }
    }
}

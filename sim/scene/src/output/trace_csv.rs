//! `trace.csv`: one row a step.

use super::{phase_name, push_number};
use crate::trace::{Column, ColumnKind};
use std::io::{self, Write};

/// Writes the rows of a trace.
#[derive(Debug)]
pub struct TraceCsv<W> {
    to: W,
    columns: Vec<Column>,
    line: String,
}

impl<W: Write> TraceCsv<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn new(mut to: W, columns: Vec<Column>) -> io::Result<Self> {
        let names: Vec<_> = columns.iter().map(|c| c.name).collect();
        writeln!(to, "{}", names.join(","))?;
        Ok(Self {
            to,
            columns,
            line: String::new(),
        })
    }

    /// Writes a row: one value a column.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn row(&mut self, values: &[f64]) -> io::Result<()> {
        self.line.clear();
        append_row(&mut self.line, &self.columns, values);
        self.to.write_all(self.line.as_bytes())
    }

    /// Gives the writer back.
    pub fn into_inner(self) -> W {
        self.to
    }
}

/// Appends a row, apart from the generic writer so that it is compiled here for every writer.
fn append_row(line: &mut String, columns: &[Column], values: &[f64]) {
    for (column, &value) in columns.iter().zip(values) {
        if !line.is_empty() {
            line.push(',');
        }
        match column.kind {
            ColumnKind::Number => push_number(line, value),
            ColumnKind::Whole => {
                let from = line.len();
                push_number(line, value);
                if line[from..].ends_with(".0") {
                    line.truncate(line.len() - 2);
                }
            }
            ColumnKind::Phase => line.push_str(phase_name(value)),
        }
    }
    line.push('\n');
}

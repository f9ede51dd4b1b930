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
        for (column, &value) in self.columns.iter().zip(values) {
            if !self.line.is_empty() {
                self.line.push(',');
            }
            match column.kind {
                ColumnKind::Number => push_number(&mut self.line, value),
                ColumnKind::Whole => {
                    let from = self.line.len();
                    push_number(&mut self.line, value);
                    if self.line[from..].ends_with(".0") {
                        self.line.truncate(self.line.len() - 2);
                    }
                }
                ColumnKind::Phase => self.line.push_str(phase_name(value)),
            }
        }
        self.line.push('\n');
        self.to.write_all(self.line.as_bytes())
    }

    /// Gives the writer back.
    pub fn into_inner(self) -> W {
        self.to
    }
}

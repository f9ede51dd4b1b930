//! Tables of numbers, as laboratories write them.
//!
//! ```text
//! bytes ─ text ─> lines ─ layout ─> names, units, separator ─ cells ─> rows, one by one
//!            └ foreign: an archive, a pointer, a web page, markers: an error that says what it is
//! ```
//! A file is recognised by its content, never by its ending. What had to be assumed is in
//! [`Table::assumptions`], for the person whose file it is.

mod cells;
mod foreign;
mod header;
mod layout;
mod number;
mod text;

#[cfg(test)]
mod tests;

pub use cells::{Separator, list};
pub use foreign::Foreign;
pub use header::Header;
pub use number::{CellError, shortened};

use cells::Cells;
use layout::{Layout, Line};
use number::Decimals;
use std::collections::VecDeque;
use std::io::{self, Read};
use text::Lines;

/// Lines at the start of a file in which the names are looked for.
const HEAD_LINES: usize = 400;

/// Bytes of them.
const HEAD_BYTES: usize = 1_000_000;

/// Place of the names of the columns.
#[derive(Clone, Copy, Debug)]
pub enum Names<'a> {
    /// In the first line that is no comment.
    FirstLine,
    /// In the first line that has these, wherever it is.
    Holding(&'a [&'a str]),
}

/// Error of a file that is no table, or whose table is broken.
#[derive(Debug, thiserror::Error)]
#[error("{}{problem}", line.map_or_else(String::new, |line| format!("line {line}: ")))]
pub struct TableError {
    /// The line as an editor counts, from 1, if it is at one.
    pub line: Option<u64>,
    /// The problem.
    pub problem: Problem,
}

/// Problem of a table.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the text of each is its error message")]
pub enum Problem {
    #[error("cannot be read: {0}; check the path and the permissions")]
    Unreadable(#[source] io::Error),
    #[error("{0}")]
    Foreign(Foreign),
    #[error("is empty; a table is a line of column names and then rows of numbers")]
    Empty,
    #[error("nothing follows \"endheader\"; a line of column names and rows are missing")]
    NoNames,
    #[error(
        "is longer than {bytes} bytes, which no row of a table is; check that the file is a table"
    )]
    LongLine { bytes: usize },
    #[error("a quote (\") opens in this line and is not closed in it; close it, or remove it")]
    UnclosedQuote,
    #[error(
        "text follows a closing quote (\") in the same cell; write two quotes for one inside a quoted cell"
    )]
    TextBehindQuote,
    #[error(
        "the file ends inside this row, with {found} of {expected} cells; \
             delete the line or copy the file again"
    )]
    CutRow { found: usize, expected: usize },
    #[error(
        "the row has {found} cells, the names are {expected}; give every row one cell for each \
             name{}", advice(*.separator)
    )]
    RowWidth {
        found: usize,
        expected: usize,
        separator: Separator,
    },
}

fn advice(separator: Separator) -> &'static str {
    match separator {
        Separator::Comma => " (a comma always separates, decimal signs are points)",
        Separator::Blanks => " (blanks separate, so a name or a cell has none)",
        _ => "",
    }
}

/// A table that is read row by row.
pub struct Table<R> {
    lines: Lines<R>,
    head: VecDeque<Line>,
    layout: Layout,
    text: String,
    cells: Cells,
    decimals: Decimals,
    comments: u64,
    empty_rows: u64,
}

impl<R: Read> Table<R> {
    /// Reads the start of a file, up to its first row.
    ///
    /// # Errors
    /// [`TableError`] of a file that is no table.
    pub fn open(reader: R, names: Names<'_>) -> Result<Self, TableError> {
        let whole = |problem| TableError {
            line: None,
            problem,
        };
        let (mut lines, first) =
            Lines::open(reader).map_err(|error| whole(Problem::Unreadable(error)))?;
        let is_utf_16 = lines.encoding().is_some();
        if let Some(foreign) = foreign::of_bytes(&first, is_utf_16) {
            return Err(whole(Problem::Foreign(foreign)));
        }
        let mut head: Vec<Line> = Vec::new();
        let (mut text, mut bytes) = (String::new(), 0);
        while head.len() < HEAD_LINES && bytes < HEAD_BYTES {
            let Some(number) = lines.next(&mut text)? else {
                break;
            };
            bytes += text.len();
            head.push((number, std::mem::take(&mut text)));
        }
        let filled = head.iter().map(|(_, text)| text.as_str());
        if let Some(foreign) = foreign::of_lines(filled.filter(|text| !text.trim().is_empty())) {
            return Err(whole(Problem::Foreign(foreign)));
        }
        let layout = layout::find(&head, names)?;
        Ok(Self {
            lines,
            head: head.into_iter().skip(layout.next).collect(),
            layout,
            text,
            cells: Cells::default(),
            decimals: Decimals::default(),
            comments: 0,
            empty_rows: 0,
        })
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.layout.names
    }

    /// The line of the names.
    pub fn names_line(&self) -> u64 {
        self.layout.names_line
    }

    /// The unit of a column in small letters, if the file has a row of units.
    pub fn unit(&self, column: usize) -> Option<String> {
        let unit = self.layout.units.get(column)?;
        Some(layout::bare_unit(unit)).filter(|unit| !unit.is_empty())
    }

    /// The header of an OpenSim file.
    pub fn header(&self) -> Option<&Header> {
        self.layout.header.as_ref()
    }

    /// Reads the next row, and returns its line; none at the end.
    ///
    /// # Errors
    /// [`TableError`] of a row that is not as wide as the names, and of text that is no table's.
    pub fn advance(&mut self) -> Result<Option<u64>, TableError> {
        let width = self.layout.names.len();
        while let Some(line) = self.next_line()? {
            if self.text.trim().is_empty() {
                continue;
            }
            if layout::is_comment(&self.text) {
                self.comments += 1;
                continue;
            }
            if let Err(quote) = self.cells.split(&self.text, self.layout.separator) {
                let problem = match quote {
                    cells::Quote::Unclosed => Problem::UnclosedQuote,
                    cells::Quote::TextBehind => Problem::TextBehindQuote,
                };
                return Err(TableError {
                    line: Some(line),
                    problem,
                });
            }
            if self.cells.iter().all(str::is_empty) {
                self.empty_rows += 1;
                continue;
            }
            self.cells.cut_padding(width);
            let found = self.cells.len();
            if found == width || self.fits_by_blanks(width) {
                return Ok(Some(line));
            }
            return Err(self.wrong_width(line, found)?);
        }
        Ok(None)
    }

    /// In an OpenSim file a single row may be separated otherwise.
    fn fits_by_blanks(&mut self, width: usize) -> bool {
        self.layout.header.is_some()
            && self.cells.split(&self.text, Separator::Blanks).is_ok()
            && self.cells.len() == width
    }

    fn wrong_width(&mut self, line: u64, found: usize) -> Result<TableError, TableError> {
        let expected = self.layout.names.len();
        let mut is_last = true;
        while self.next_line()?.is_some() {
            if !self.text.trim().is_empty() {
                is_last = false;
                break;
            }
        }
        let problem = if is_last && found < expected {
            Problem::CutRow { found, expected }
        } else {
            Problem::RowWidth {
                found,
                expected,
                separator: self.layout.separator,
            }
        };
        Ok(TableError {
            line: Some(line),
            problem,
        })
    }

    fn next_line(&mut self) -> Result<Option<u64>, TableError> {
        if let Some((line, text)) = self.head.pop_front() {
            self.text = text;
            return Ok(Some(line));
        }
        self.lines.next(&mut self.text)
    }

    /// A cell of the row that was read last.
    pub fn cell(&self, column: usize) -> &str {
        self.cells.get(column)
    }

    /// A number of the row that was read last.
    ///
    /// # Errors
    /// [`CellError`] of a cell that is none.
    pub fn number(&mut self, column: usize) -> Result<f64, CellError> {
        self.decimals.number(self.cells.get(column))
    }

    /// A cell of the row that was read last, with a point for a decimal comma.
    pub fn value(&self, column: usize) -> String {
        let cell = self.cells.get(column);
        match number::with_comma(cell) {
            Some(_) if self.layout.separator != Separator::Comma => cell.replace(',', "."),
            _ => cell.to_owned(),
        }
    }

    /// Assumptions about the file so far, a sentence each.
    pub fn assumptions(&self) -> Vec<String> {
        let mut all = self.layout.notes.clone();
        if let Some(encoding) = self.lines.encoding() {
            all.push(format!("the text is {encoding}, not UTF-8"));
        }
        if self.decimals.has_comma() {
            all.push("numbers have decimal commas".to_owned());
        }
        for (count, what) in [
            (self.comments, "lines of comment"),
            (self.empty_rows, "rows without a value"),
        ] {
            if count > 0 {
                all.push(format!("{what} left out: {count}"));
            }
        }
        all
    }
}

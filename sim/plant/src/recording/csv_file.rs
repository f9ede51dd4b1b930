//! The CSV reader: one line of column names, then rows, separated by commas.
//!
//! Spaces around cells, a UTF-8 byte order mark and CR LF line ends are accepted, and so is a last
//! line without an end: many programs write it so.

use super::table::Table;
use super::{Place, RecordingError, Samples, Source};
use std::fs::File;
use std::io::Read;

pub(super) fn read(source: &Source<'_>, file: File) -> Result<Samples, RecordingError> {
    let mut rows = Rows::new(source, file);
    let mut record = csv::StringRecord::new();

    let Some(line) = rows.next(&mut record)? else {
        return Err(RecordingError::Empty {
            place: Place::file(source.path),
        });
    };
    let names: Vec<&str> = record.iter().collect();
    if let [only] = names.as_slice()
        && let Some(separator) = only.chars().find(|c| matches!(c, ';' | '\t' | '|'))
    {
        let place = Place::line(source.path, line);
        return Err(RecordingError::NotCommaSeparated { place, separator });
    }
    let mut table = Table::new(source, line, &names)?;

    while let Some(line) = rows.next(&mut record)? {
        if record.len() != table.width() {
            let found = record.len();
            let is_last = rows.next(&mut record)?.is_none();
            return Err(table.wrong_width(line, found, is_last));
        }
        table.push(line, &record.iter())?;
    }
    table.finish(false)
}

struct Rows<'a> {
    source: &'a Source<'a>,
    reader: csv::Reader<std::io::Chain<File, &'static [u8]>>,
}

impl<'a> Rows<'a> {
    fn new(source: &'a Source<'a>, file: File) -> Self {
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            // CR is then a space at the end of the line, and lines are counted by LF alone.
            .terminator(csv::Terminator::Any(b'\n'))
            // Every line ends for certain, so that the line of a row is one less than the next.
            .from_reader(file.chain(b"\n".as_slice()));
        Self { source, reader }
    }

    /// The next row that is not blank, and its line.
    fn next(&mut self, record: &mut csv::StringRecord) -> Result<Option<u64>, RecordingError> {
        loop {
            let more = self.reader.read_record(record);
            let line = self.reader.position().line().saturating_sub(1);
            let more = more.map_err(|error| self.describe(error, line))?;
            if !more {
                return Ok(None);
            }
            if record.len() > 1 || record.iter().any(|cell| !cell.is_empty()) {
                return Ok(Some(line));
            }
        }
    }

    fn describe(&self, error: csv::Error, line: u64) -> RecordingError {
        let path = self.source.path;
        match error.into_kind() {
            csv::ErrorKind::Io(source) => RecordingError::Unreadable {
                place: Place::file(path),
                source,
            },
            // With rows of any length allowed, the one other error is text that is not UTF-8.
            _ => RecordingError::NotText {
                place: Place::line(path, line),
            },
        }
    }
}

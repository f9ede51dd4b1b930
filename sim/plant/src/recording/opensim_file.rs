//! The OpenSim reader: motion (`.mot`) and storage (`.sto`) files.
//!
//! ```text
//! Coordinates              free lines, and lines of key=value (older files: key value)
//! nRows=158
//! nColumns=36
//! inDegrees=yes
//! endheader
//! time  pelvis_tilt  …     names, separated by tabs or spaces
//! 0.00  12.2         …     rows
//! ```
//! Source: OpenSim documentation, "Motion (.mot) files" and "Storage (.sto) files"; the older keys
//! `datarows` and `datacolumns` are those of SIMM.

use super::table::Table;
use super::{AngleUnit, Place, RecordingError, Samples, Source, Warning};
use std::fs::File;
use std::io::{BufRead, BufReader};

pub(super) fn read(source: &Source<'_>, file: File) -> Result<Samples, RecordingError> {
    let path = source.path;
    let mut lines = Lines {
        source,
        reader: BufReader::new(file),
        number: 0,
        bytes: Vec::new(),
    };
    let header = Header::read(source, &mut lines)?;

    let Some((names_line, names_text)) = lines.next_filled()? else {
        return Err(RecordingError::NoLabels {
            place: Place::line(path, lines.number),
        });
    };
    let names: Vec<&str> = if names_text.contains('\t') {
        names_text.split('\t').map(str::trim).collect()
    } else {
        names_text.split_whitespace().collect()
    };
    let mut table = Table::new(source, names_line, &names)?;
    if let Some((line, declared)) = header.columns
        && declared != table.width() as u64
    {
        let found = table.width() as u64;
        let place = Place::line(path, line);
        table.warn(Warning::DeclaredColumns {
            place,
            declared,
            found,
        });
    }

    while let Some((line, text)) = lines.next_filled()? {
        // Tabs tell an empty cell from padding; only where they do not fit, any space separates.
        let by_tab = text.split('\t').map(str::trim);
        let by_space = text.split_whitespace();
        if by_tab.clone().count() == table.width() {
            table.push(line, &by_tab)?;
        } else if by_space.clone().count() == table.width() {
            table.push(line, &by_space)?;
        } else {
            let found = by_space.count();
            let is_last = lines.next_filled()?.is_none();
            return Err(table.wrong_width(line, found, is_last));
        }
    }

    let found = table.rows() as u64;
    if let Some((line, declared)) = header.rows
        && declared != found
    {
        let place = Place::line(path, line);
        table.warn(Warning::DeclaredRows {
            place,
            declared,
            found,
        });
    }
    table.finish(header.names_unit)
}

/// Declarations of the header, with their lines.
#[derive(Default)]
struct Header {
    rows: Option<(u64, u64)>,
    columns: Option<(u64, u64)>,
    names_unit: bool,
}

impl Header {
    fn read(source: &Source<'_>, lines: &mut Lines<'_>) -> Result<Self, RecordingError> {
        let mut header = Self::default();
        while let Some((line, text)) = lines.next_filled()? {
            if text.eq_ignore_ascii_case("endheader") {
                return Ok(header);
            }
            let Some((key, value)) = text
                .split_once('=')
                .or_else(|| text.split_once(char::is_whitespace))
                .map(|(key, value)| (key.trim().to_ascii_lowercase(), value.trim()))
            else {
                continue;
            };
            match key.as_str() {
                "nrows" | "datarows" => header.rows = value.parse().ok().map(|n| (line, n)),
                "ncolumns" | "datacolumns" => {
                    header.columns = value.parse().ok().map(|n| (line, n));
                }
                "indegrees" => {
                    let Some(unit) = unit(value) else { continue };
                    if source.unit.is_some_and(|said| said != unit) {
                        return Err(RecordingError::UnitContradiction {
                            place: Place::line(source.path, line),
                            header: format!("inDegrees={value}"),
                            unit,
                        });
                    }
                    header.names_unit = true;
                }
                _ => {}
            }
        }
        let place = Place::file(source.path);
        Err(if lines.number == 0 {
            RecordingError::Empty { place }
        } else {
            RecordingError::NoEndHeader { place }
        })
    }
}

fn unit(in_degrees: &str) -> Option<AngleUnit> {
    match in_degrees.to_ascii_lowercase().as_str() {
        "yes" | "y" | "true" | "1" => Some(AngleUnit::Deg),
        "no" | "n" | "false" | "0" => Some(AngleUnit::Rad),
        _ => None,
    }
}

struct Lines<'a> {
    source: &'a Source<'a>,
    reader: BufReader<File>,
    number: u64,
    bytes: Vec<u8>,
}

impl Lines<'_> {
    /// The next line that is not blank, without spaces and tabs that only pad it at the end.
    fn next_filled(&mut self) -> Result<Option<(u64, &str)>, RecordingError> {
        let path = self.source.path;
        loop {
            self.bytes.clear();
            let read = self
                .reader
                .read_until(b'\n', &mut self.bytes)
                .map_err(|source| RecordingError::Unreadable {
                    place: Place::file(path),
                    source,
                })?;
            if read == 0 {
                return Ok(None);
            }
            self.number += 1;
            if !self.bytes.trim_ascii().is_empty() {
                break;
            }
        }
        let text = str::from_utf8(&self.bytes).map_err(|_| RecordingError::NotText {
            place: Place::line(path, self.number),
        })?;
        Ok(Some((
            self.number,
            text.trim_start_matches('\u{feff}').trim_end(),
        )))
    }
}

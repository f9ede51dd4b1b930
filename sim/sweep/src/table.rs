//! Table of a sweep from its parts: a row per run, in the order of their points.

#[cfg(feature = "parquet")]
mod parquet;

use crate::parts::{Column, Kind, PartError, Parts, missing, scratch_file};
use crate::plan::Identity;
use crate::row::FAILURE;
use std::collections::HashMap;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Column of the point's number.
pub const INDEX: &str = "index";

/// File format of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Parquet; needs the feature `parquet`.
    Parquet,
    /// CSV; numbers are read back to the same bits.
    Csv,
}

impl Format {
    /// Default format: Parquet, if the program was built with it.
    pub const DEFAULT: Self = if cfg!(feature = "parquet") {
        Self::Parquet
    } else {
        Self::Csv
    };

    /// Returns the name of the format.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Parquet => "parquet",
            Self::Csv => "csv",
        }
    }

    /// Returns the name of the file.
    pub const fn file(self) -> &'static str {
        match self {
            Self::Parquet => "sweep.parquet",
            Self::Csv => "sweep.csv",
        }
    }
}

impl FromStr for Format {
    type Err = &'static str;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "csv" => Ok(Self::Csv),
            "parquet" if cfg!(feature = "parquet") => Ok(Self::Parquet),
            "parquet" => Err(
                "this program was built without Parquet: build it with --features parquet, or use csv",
            ),
            _ => Err("expected parquet or csv"),
        }
    }
}

/// Error of writing a table.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// Rows are missing.
    #[error("{missing} of {runs} runs are not there: points {ranges}")]
    Incomplete {
        /// Number of missing runs.
        missing: u64,
        /// Number of all runs.
        runs: u64,
        /// First missing points, as ranges.
        ranges: String,
    },
    /// A part cannot be read.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A file cannot be written, or the caller has cancelled ([`io::ErrorKind::Interrupted`]).
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// A written table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// Path of the file.
    pub file: PathBuf,
    /// Its size, bytes.
    pub bytes: u64,
    /// Number of failed runs.
    pub failed: u64,
}

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) kind: Kind,
}

/// Rows of neighbouring points of one part.
pub(crate) struct Chunk {
    points: Range<u64>,
    /// Number of rows of the part before the first of these.
    skipped: usize,
    /// Columns of the part by the index of their field.
    columns: Vec<Option<Column>>,
}

impl Chunk {
    fn rows(&self) -> usize {
        usize::try_from(self.points.end - self.points.start).unwrap_or(usize::MAX)
    }

    /// Returns the cell of a field, empty if there is none.
    fn cell(&self, field: usize, row: usize) -> &str {
        let column = self.columns.get(field).and_then(Option::as_ref);
        column.map_or("", |column| column.cells.get(self.skipped + row))
    }
}

/// Writes the table of a sweep into `folder`, whole or not at all. `progress` gets the completed
/// share, 0 to 1, and cancels by returning false.
///
/// # Errors
/// [`TableError`].
pub fn write(
    parts: &Parts,
    identity: &Identity,
    folder: &Path,
    format: Format,
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<Written, TableError> {
    let there = parts.points()?;
    check_complete(&there, identity.runs)?;
    let table = Table {
        parts,
        points: without_overlaps(&there, identity.runs),
        fields: Vec::new(),
    };
    let table = table.with_fields(&mut |share| progress(share / 2.0))?;
    let failed = table.fields.iter().position(|f| f.name == FAILURE);
    let mut count = 0;
    let mut file = scratch_file(parts.folder())?;
    let mut seen = |chunk: &Chunk, share: f64| {
        let reasons = failed
            .map(|field| (0..chunk.rows()).filter(move |&r| !chunk.cell(field, r).is_empty()));
        count += reasons.map_or(0, Iterator::count) as u64;
        progress(0.5 + share / 2.0)
    };
    match format {
        Format::Csv => table.write_csv(file.as_file_mut(), &mut seen)?,
        #[cfg(feature = "parquet")]
        Format::Parquet => table.write_parquet(file.as_file_mut(), identity, &mut seen)?,
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => return Err(io::Error::from(io::ErrorKind::Unsupported).into()),
    }
    file.as_file().sync_all()?;
    let bytes = file.as_file().metadata()?.len();
    let target = folder.join(format.file());
    file.persist(&target).map_err(io::Error::from)?;
    Ok(Written {
        file: target,
        bytes,
        failed: count,
    })
}

/// Rejects parts that do not cover all runs.
fn check_complete(there: &[Range<u64>], runs: u64) -> Result<(), TableError> {
    /// Most ranges in the error.
    const NAMED: usize = 8;
    let gaps = missing(0..runs, there);
    if gaps.is_empty() {
        return Ok(());
    }
    let named = gaps.iter().take(NAMED);
    let mut ranges: Vec<_> = named
        .map(|gap| match gap.end - gap.start {
            1 => gap.start.to_string(),
            _ => format!("{} to {}", gap.start, gap.end - 1),
        })
        .collect();
    if gaps.len() > NAMED {
        ranges.push("…".to_owned());
    }
    Err(TableError::Incomplete {
        missing: gaps.iter().map(|gap| gap.end - gap.start).sum(),
        runs,
        ranges: ranges.join(", "),
    })
}

/// Returns the parts with those of their points that no earlier part has.
fn without_overlaps(there: &[Range<u64>], runs: u64) -> Vec<(Range<u64>, Range<u64>)> {
    let mut next = 0;
    let mut kept = Vec::new();
    for part in there {
        let points = part.start.max(next)..part.end.min(runs);
        if points.start < points.end {
            next = points.end;
            kept.push((part.clone(), points));
        }
    }
    kept
}

struct Table<'p> {
    parts: &'p Parts,
    /// Parts, each with its points that go into the table.
    points: Vec<(Range<u64>, Range<u64>)>,
    fields: Vec<Field>,
}

impl Table<'_> {
    /// Collects names and kinds of all columns.
    fn with_fields(mut self, progress: &mut dyn FnMut(f64) -> bool) -> Result<Self, TableError> {
        let mut places: HashMap<String, usize> = HashMap::new();
        for (number, (part, _)) in self.points.iter().enumerate() {
            for column in self.parts.read(part)? {
                let place = *places
                    .entry(column.name.clone())
                    .or_insert(self.fields.len());
                match self.fields.get_mut(place) {
                    Some(field) => field.kind = field.kind.and(column.kind),
                    None => self.fields.push(Field {
                        name: column.name,
                        kind: column.kind,
                    }),
                }
            }
            unless_cancelled(progress(share(number + 1, self.points.len())))?;
        }
        if !places.contains_key(FAILURE) {
            self.fields.push(Field {
                name: FAILURE.to_owned(),
                kind: Kind::Text,
            });
        }
        Ok(self)
    }

    /// Passes the rows in their order to `take`, a part at a time.
    fn each_chunk(
        &self,
        seen: &mut dyn FnMut(&Chunk, f64) -> bool,
        take: &mut dyn FnMut(Chunk) -> io::Result<()>,
    ) -> Result<(), TableError> {
        let places: HashMap<&str, usize> = self
            .fields
            .iter()
            .enumerate()
            .map(|(place, field)| (field.name.as_str(), place))
            .collect();
        for (number, (part, points)) in self.points.iter().enumerate() {
            let mut columns = vec![None; self.fields.len()];
            for column in self.parts.read(part)? {
                if let Some(&place) = places.get(column.name.as_str()) {
                    columns[place] = Some(column);
                }
            }
            let skipped = points.start - part.start;
            let chunk = Chunk {
                points: points.clone(),
                skipped: usize::try_from(skipped).unwrap_or(usize::MAX),
                columns,
            };
            unless_cancelled(seen(&chunk, share(number + 1, self.points.len())))?;
            take(chunk)?;
        }
        Ok(())
    }

    fn write_csv(
        &self,
        file: impl Write,
        seen: &mut dyn FnMut(&Chunk, f64) -> bool,
    ) -> Result<(), TableError> {
        let mut writer = csv::Writer::from_writer(io::BufWriter::with_capacity(1 << 16, file));
        let names = self.fields.iter().map(|field| field.name.as_str());
        writer
            .write_record([INDEX].into_iter().chain(names))
            .map_err(io::Error::from)?;
        self.each_chunk(seen, &mut |chunk| {
            for row in 0..chunk.rows() {
                writer.write_field((chunk.points.start + row as u64).to_string())?;
                for field in 0..self.fields.len() {
                    writer.write_field(chunk.cell(field, row))?;
                }
                writer.write_record(None::<&[u8]>)?;
            }
            Ok(())
        })?;
        writer.flush()?;
        Ok(())
    }
}

/// Returns an error if the caller has cancelled.
fn unless_cancelled(continues: bool) -> io::Result<()> {
    if continues {
        Ok(())
    } else {
        Err(io::ErrorKind::Interrupted.into())
    }
}

#[expect(clippy::cast_precision_loss, reason = "a share for people")]
fn share(done: usize, of: usize) -> f64 {
    done as f64 / of.max(1) as f64
}

#[cfg(test)]
mod tests;

//! Table of a sweep from its parts: a row per run, in the order of their points.

#[cfg(feature = "parquet")]
mod parquet;
mod read;

pub use read::{Content, of_parts, read};

use crate::sweep::kind::Kind;
use crate::sweep::parts::{Column, PartError, Parts, missing};
use crate::sweep::plan::Identity;
use crate::sweep::row::FAILURE;
use crepitus_files::output::{OutputError, hex, sha256};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use tempfile::NamedTempFile;

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

    /// Returns the format of a file of this name, if this program writes it.
    pub(crate) fn of_file(name: &str) -> Option<Self> {
        let is_of = |format: &Self| format.file() == name && format.name().parse() == Ok(*format);
        [Self::Parquet, Self::Csv].into_iter().find(is_of)
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
    /// A part cannot be read, or is not as it was written.
    #[error(transparent)]
    Part(#[from] PartError),
    /// Two parts have other rows for the same point.
    #[error("{} and {} have other rows for point {point}: move away the one that is wrong, and the sweep runs its \
             points again", parts[0].display(), parts[1].display())]
    Doubled {
        /// The parts.
        parts: [PathBuf; 2],
        /// The point.
        point: u64,
    },
    /// The table, read back, is not what was written.
    #[error(
        "the table, read back from the disk, is not what was written: the parts are kept; check the disk, and \
             give the same command again"
    )]
    ReadBack,
    /// Something is in the way.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file cannot be written, or the caller has cancelled ([`io::ErrorKind::Interrupted`]).
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// A written table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// Path of the file.
    pub file: PathBuf,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Number of failed runs.
    pub failed: u64,
    /// Number of points that two parts have, with the same rows.
    pub doubled: u64,
    /// SHA-256 of the file, in hex digits.
    pub sha256: String,
}

/// A complete table that is not in its place yet.
#[derive(Debug)]
pub struct Table {
    /// The file, which is removed if it is dropped.
    pub file: NamedTempFile,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Number of failed runs.
    pub failed: u64,
    /// Number of points that two parts have, with the same rows.
    pub doubled: u64,
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

/// Writes the table of a sweep beside its parts, and reads it back. `progress` gets the completed
/// share, 0 to 1, and cancels by returning false.
///
/// # Errors
/// [`TableError`].
pub fn write(
    parts: &Parts,
    identity: &Identity,
    format: Format,
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<Table, TableError> {
    let there = parts.points()?;
    check_complete(&there, identity.runs)?;
    let doubled = doubled(parts, &there)?;
    let rows = Rows {
        parts,
        points: without_overlaps(&there, identity.runs),
        fields: Vec::new(),
    };
    let rows = rows.with_fields(&mut |share| progress(share / 2.0))?;
    let failed = rows.fields.iter().position(|f| f.name == FAILURE);
    let mut count = 0;
    let file = parts.temporary()?;
    let mut seen = |chunk: &Chunk, share: f64| {
        let reasons = failed
            .map(|field| (0..chunk.rows()).filter(move |&r| !chunk.cell(field, r).is_empty()));
        count += reasons.map_or(0, Iterator::count) as u64;
        progress(0.5 + share / 2.0)
    };
    let mut hashing = Hashing::of(file.reopen()?);
    match format {
        Format::Csv => rows.write_csv(&mut hashing, &mut seen)?,
        #[cfg(feature = "parquet")]
        Format::Parquet => rows.write_parquet(&mut hashing, identity, &mut seen)?,
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => return Err(io::Error::from(io::ErrorKind::Unsupported).into()),
    }
    hashing.read_back(file.path())?;
    let bytes = file.as_file().metadata()?.len();
    Ok(Table {
        file,
        bytes,
        failed: count,
        doubled,
    })
}

/// File whose content is hashed on the way.
struct Hashing {
    file: File,
    sha: Sha256,
}

impl Hashing {
    fn of(file: File) -> Self {
        let sha = Sha256::new();
        Self { file, sha }
    }

    /// Checks that the disk, asked for the file at this path, has what was written.
    fn read_back(self, path: &Path) -> Result<(), TableError> {
        self.file.sync_all()?;
        if sha256(File::open(path)?)? == hex(&self.sha.finalize()) {
            Ok(())
        } else {
            Err(TableError::ReadBack)
        }
    }
}

impl Write for Hashing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.sha.update(bytes.get(..count).unwrap_or_default());
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Counts the points that several parts have; all have to have the same rows of them.
fn doubled(parts: &Parts, there: &[Range<u64>]) -> Result<u64, TableError> {
    let (mut count, mut end) = (0, 0);
    for (number, part) in there.iter().enumerate() {
        if part.start < end {
            count += part.end.min(end) - part.start;
            let overlapping = |other: &&Range<u64>| other.end > part.start;
            for other in there[..number].iter().filter(overlapping) {
                compare(parts, other, part)?;
            }
        }
        end = end.max(part.end);
    }
    Ok(count)
}

/// Rejects two parts that have other rows for a point that both have.
fn compare(parts: &Parts, a: &Range<u64>, b: &Range<u64>) -> Result<(), TableError> {
    let place = |point: u64, part: &Range<u64>| usize::try_from(point - part.start).unwrap_or(0);
    let by_name = |part: &Range<u64>| -> Result<HashMap<String, Column>, PartError> {
        let columns = parts.read(part)?.into_iter();
        Ok(columns
            .map(|column| (column.name.clone(), column))
            .collect())
    };
    let (of_a, of_b) = (by_name(a)?, by_name(b)?);
    for point in a.start.max(b.start)..a.end.min(b.end) {
        let cell = |columns: &HashMap<String, Column>, name: &str, part: &Range<u64>| {
            let column = columns.get(name);
            column.map_or(String::new(), |c| {
                c.cells.get(place(point, part)).to_owned()
            })
        };
        let names = of_a.keys().chain(of_b.keys());
        let differs = |name: &&String| cell(&of_a, name, a) != cell(&of_b, name, b);
        if names.into_iter().any(|name| differs(&name)) {
            return Err(TableError::Doubled {
                parts: [parts.file(a), parts.file(b)],
                point,
            });
        }
    }
    Ok(())
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

struct Rows<'p> {
    parts: &'p Parts,
    /// Parts, each with its points that go into the table.
    points: Vec<(Range<u64>, Range<u64>)>,
    fields: Vec<Field>,
}

impl Rows<'_> {
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

//! Part files of a sweep: rows in files that appear whole or not at all, so that a killed sweep can
//! be resumed and several computers can write into one folder.
//!
//! A part has the rows of neighbouring points, which its name tells. It says of which sweep and shard it
//! is, which points and how many columns it has, and ends with a SHA-256 of itself ([`format`]): a part that
//! was damaged, changed, renamed, or is of another sweep is named, and makes no table.

mod format;

use crate::sweep::kind::Kind;
use crate::sweep::plan::{Identity, Shard};
use crate::sweep::row::Row;
use crepitus_files::output::temporary_with_prefix;
use format::Header;
use std::collections::HashMap;
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Column of a part, with its cells as text; a missing cell is empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the column.
    pub name: String,
    /// Kind of its cells.
    pub kind: Kind,
    /// Cells of the column.
    pub cells: Cells,
}

/// The cells of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cells {
    /// One value for every row.
    Constant(String),
    /// One value per row.
    Each(Vec<String>),
}

impl Cells {
    /// Returns the cell of a row.
    pub fn get(&self, row: usize) -> &str {
        match self {
            Self::Constant(text) => text,
            Self::Each(texts) => texts.get(row).map_or("", String::as_str),
        }
    }
}

/// Returns the columns of neighbouring rows, in the order in which they first appear.
fn columns(rows: &[Row]) -> Vec<Column> {
    let mut places: HashMap<&str, usize> = HashMap::new();
    let mut found: Vec<(&str, Kind, Vec<String>)> = Vec::new();
    for (number, row) in rows.iter().enumerate() {
        for (name, cell) in &row.cells {
            let (kind, text) = (cell.kind(), cell.to_string());
            let place = *places.entry(name).or_insert_with(|| {
                found.push((name, kind, vec![String::new(); rows.len()]));
                found.len() - 1
            });
            let (_, of_column, texts) = &mut found[place];
            *of_column = of_column.and(kind);
            texts[number] = text;
        }
    }
    let column = |(name, kind, texts): (&str, Kind, Vec<String>)| {
        let is_constant = texts.len() > 1 && texts.windows(2).all(|w| w[0] == w[1]);
        Column {
            name: name.to_owned(),
            kind,
            cells: match texts.first() {
                Some(first) if is_constant => Cells::Constant(first.clone()),
                _ => Cells::Each(texts),
            },
        }
    };
    found.into_iter().map(column).collect()
}

/// Part files of one sweep in a folder.
#[derive(Clone, Debug)]
pub struct Parts {
    folder: PathBuf,
    /// [`Identity::id`].
    sweep: String,
    runs: u64,
    /// Shard whose rows are written.
    shard: Shard,
}

/// Error of a part file that is not a part of this sweep as it was written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}: move it away, and the sweep runs its points again", file.display())]
pub struct PartError {
    file: PathBuf,
    why: String,
}

impl Parts {
    /// Names the folder, which need not exist, the sweep, and the shard whose rows are written.
    pub fn of(folder: PathBuf, sweep: &Identity, shard: Shard) -> Self {
        Self {
            folder,
            sweep: sweep.id(),
            runs: sweep.runs,
            shard,
        }
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Creates a temporary file, which is removed if it is dropped. Its name has the sweep, so that one that
    /// a killed program has left is known.
    pub(crate) fn temporary(&self) -> io::Result<NamedTempFile> {
        temporary_with_prefix(&self.folder, &self.temporary_prefix())
    }

    fn temporary_prefix(&self) -> String {
        format!(".part-{}-", self.sweep.get(..16).unwrap_or_default())
    }

    /// Returns the path of the part with these points.
    pub fn file(&self, points: &Range<u64>) -> PathBuf {
        self.folder.join(name_of(points))
    }

    fn refuse(&self, points: &Range<u64>, why: impl Into<String>) -> PartError {
        PartError {
            file: self.file(points),
            why: why.into(),
        }
    }

    /// Lists the points of each part, in their order.
    ///
    /// # Errors
    /// If the folder cannot be read.
    pub fn points(&self) -> io::Result<Vec<Range<u64>>> {
        let mut found: Vec<_> = (self.names()?.iter())
            .filter_map(|name| points_of(name))
            .collect();
        found.sort_by_key(|points| (points.start, points.end));
        Ok(found)
    }

    /// Lists the parts, each of which is read and verified.
    ///
    /// # Errors
    /// The first that is not a part of this sweep as it was written, or the folder cannot be read.
    pub fn verified(&self) -> io::Result<Vec<Range<u64>>> {
        let there = self.points()?;
        for points in &there {
            self.bytes(points).map_err(io::Error::other)?;
        }
        Ok(there)
    }

    fn names(&self) -> io::Result<Vec<String>> {
        let entries = match fs::read_dir(&self.folder) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let mut names = Vec::new();
        for entry in entries {
            names.extend(entry?.file_name().into_string().ok());
        }
        Ok(names)
    }

    /// Writes rows; those of neighbouring points become one part.
    ///
    /// # Errors
    /// If a part cannot be written, or another file has its name; no incomplete part is left then.
    pub fn write(&self, rows: &[Row]) -> io::Result<()> {
        let is_next = |a: &Row, b: &Row| b.index == a.index + 1;
        for rows in rows.chunk_by(is_next) {
            let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
                continue;
            };
            let points = first.index..last.index + 1;
            let bytes = format::write(&self.header(&points), &columns(rows))?;
            self.put(&points, &bytes)?;
        }
        Ok(())
    }

    fn header(&self, points: &Range<u64>) -> Header {
        Header {
            sweep: self.sweep.clone(),
            shard: self.shard,
            points: points.clone(),
        }
    }

    /// Puts a part in its place, unless it is there already.
    fn put(&self, points: &Range<u64>, bytes: &[u8]) -> io::Result<()> {
        if fs::symlink_metadata(self.file(points)).is_ok() {
            return self.is_there(points, bytes);
        }
        let mut file = self.temporary()?;
        file.write_all(bytes)?;
        file.as_file().sync_data()?;
        match file.persist_noclobber(self.file(points)) {
            Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => {
                self.is_there(points, bytes)
            }
            moved => moved.map(drop).map_err(io::Error::from),
        }
    }

    /// Checks that a part is there with the same rows: another program may have run the same points, as
    /// another shard.
    fn is_there(&self, points: &Range<u64>, bytes: &[u8]) -> io::Result<()> {
        let rows = |bytes: &[u8]| format::read(bytes, points).map(|(_, columns)| columns);
        let there = self.bytes(points).map_err(io::Error::other)?;
        if rows(&there) == rows(bytes) {
            return Ok(());
        }
        let why = "there are other rows of these points in it";
        Err(io::Error::other(self.refuse(points, why)))
    }

    /// Reads the columns of a part.
    ///
    /// # Errors
    /// [`PartError`] if the file is not a part of this sweep as it was written, or cannot be read.
    pub fn read(&self, points: &Range<u64>) -> Result<Vec<Column>, PartError> {
        let bytes = self.bytes(points)?;
        let read = format::read(&bytes, points).map_err(|why| self.refuse(points, why))?;
        Ok(read.1)
    }

    /// Reads and verifies a part: checksum, sweep, shard and points.
    fn bytes(&self, points: &Range<u64>) -> Result<Vec<u8>, PartError> {
        let refuse = |why: String| self.refuse(points, why);
        let file = self.file(points);
        let metadata = fs::symlink_metadata(&file).map_err(|e| refuse(e.to_string()))?;
        if !metadata.is_file() {
            return Err(refuse("this is not a regular file".to_owned()));
        }
        if metadata.len() > format::MOST_BYTES {
            return Err(refuse("this is larger than any part".to_owned()));
        }
        let bytes = fs::read(&file).map_err(|e| refuse(e.to_string()))?;
        let (header, _) = format::read(&bytes, points).map_err(refuse)?;
        let Header { sweep, shard, .. } = header;
        if sweep != self.sweep {
            return Err(refuse("this is a part of another sweep".to_owned()));
        }
        let of_shard = shard.points(self.runs);
        if points.start < of_shard.start || points.end > of_shard.end {
            let why = format!(
                "points {} to {} are not of shard {shard}",
                points.start,
                points.end - 1
            );
            return Err(refuse(why));
        }
        Ok(bytes)
    }

    /// Copies the parts of another folder, each verified, and whole or not at all.
    ///
    /// # Errors
    /// If a part cannot be read or written, or is not of this sweep.
    pub fn copy_from(&self, other: &Self) -> io::Result<()> {
        for points in other.verified()? {
            let bytes = other.bytes(&points).map_err(io::Error::other)?;
            self.put(&points, &bytes)?;
        }
        Ok(())
    }

    /// Removes the parts, and what a killed program has left of this sweep; no other file.
    ///
    /// # Errors
    /// If a part cannot be removed.
    pub fn remove(&self) -> io::Result<()> {
        for points in self.points()? {
            if self.bytes(&points).is_ok() {
                fs::remove_file(self.file(&points))?;
            }
        }
        let prefix = self.temporary_prefix();
        for name in self.names()? {
            if name.starts_with(&prefix) {
                fs::remove_file(self.folder.join(name))?;
            }
        }
        Ok(())
    }
}

/// Name of the part with these points.
fn name_of(points: &Range<u64>) -> String {
    format!("{:010}-{:010}.csv", points.start, points.end)
}

/// Parses the points from the name of a part.
fn points_of(name: &str) -> Option<Range<u64>> {
    let (first, end) = name.strip_suffix(".csv")?.split_once('-')?;
    let points = first.parse().ok()?..end.parse().ok()?;
    // No other spelling.
    (points.start < points.end && name_of(&points) == name).then_some(points)
}

/// Returns the ranges of `wanted` that no part of `there` covers. `there` is sorted by its starts.
pub fn missing(wanted: Range<u64>, there: &[Range<u64>]) -> Vec<Range<u64>> {
    let mut gaps = Vec::new();
    let mut next = wanted.start;
    for part in there {
        let end = part.start.min(wanted.end);
        if next < end {
            gaps.push(next..end);
        }
        next = next.max(part.end);
    }
    if next < wanted.end {
        gaps.push(next..wanted.end);
    }
    gaps
}

#[cfg(test)]
mod tests;

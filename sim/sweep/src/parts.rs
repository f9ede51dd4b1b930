//! Part files of a sweep: rows in files that appear whole or not at all, so that a killed sweep can
//! be resumed and several computers can write into one folder.
//!
//! A part has the rows of neighbouring points, which its name tells. It is CSV with a
//! record a *column*: name, kind, then a value a row, or one value for all rows; most
//! columns of a sweep do not vary, and a table is written column by column.

use crate::row::Row;
use crepitus_files::input;
use std::collections::HashMap;
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Integers.
    Whole,
    /// Numbers.
    Number,
    /// Texts.
    Text,
}

/// Column of a part, with its cells as text; a missing cell is empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Kind of its cells.
    pub kind: Kind,
    /// Its cells.
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

impl Kind {
    const ALL: [(Self, &'static str); 3] = [
        (Self::Whole, "whole"),
        (Self::Number, "number"),
        (Self::Text, "text"),
    ];

    fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(kind, _)| *kind == self)
            .map_or("", |(_, name)| name)
    }

    fn of(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .find(|(_, its)| *its == name)
            .map(|(kind, _)| *kind)
    }

    /// Returns the kind of a column with cells of both kinds.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (a, b) if a == b => a,
            (Self::Text, _) | (_, Self::Text) => Self::Text,
            _ => Self::Number,
        }
    }
}

/// Creates a temporary file, which is removed if it is dropped. Once persisted it can be read by
/// others, as far as the user's mask allows.
pub(crate) fn scratch_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".part-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
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

/// Folder of the part files.
#[derive(Clone, Debug)]
pub struct Parts {
    folder: PathBuf,
}

/// Error of a damaged part file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}: remove it, and the sweep runs its points again", file.display())]
pub struct PartError {
    file: PathBuf,
    why: String,
}

impl Parts {
    /// Names the folder, which need not exist.
    pub const fn in_folder(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn file(&self, points: &Range<u64>) -> PathBuf {
        self.folder
            .join(format!("{:010}-{:010}.csv", points.start, points.end))
    }

    /// Lists the points of each part, in their order.
    ///
    /// # Errors
    /// If the folder cannot be read.
    pub fn points(&self) -> io::Result<Vec<Range<u64>>> {
        let entries = match fs::read_dir(&self.folder) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let mut found = Vec::new();
        for entry in entries {
            let name = entry?.file_name();
            found.extend(name.to_str().and_then(points_of));
        }
        found.sort_by_key(|points| (points.start, points.end));
        Ok(found)
    }

    /// Writes rows; those of neighbouring points become one part.
    ///
    /// # Errors
    /// If a part cannot be written; no incomplete part is left then.
    pub fn write(&self, rows: &[Row]) -> io::Result<()> {
        let is_next = |a: &Row, b: &Row| b.index == a.index + 1;
        for rows in rows.chunk_by(is_next) {
            let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
                continue;
            };
            self.write_part(&(first.index..last.index + 1), &columns(rows))?;
        }
        Ok(())
    }

    fn write_part(&self, points: &Range<u64>, columns: &[Column]) -> io::Result<()> {
        let mut file = scratch_file(&self.folder)?;
        {
            let buffered = io::BufWriter::with_capacity(1 << 16, file.as_file_mut());
            let mut writer = csv::WriterBuilder::new()
                .flexible(true)
                .from_writer(buffered);
            for column in columns {
                writer.write_field(&column.name)?;
                writer.write_field(column.kind.name())?;
                match &column.cells {
                    Cells::Constant(text) => writer.write_field(text)?,
                    Cells::Each(texts) => {
                        for text in texts {
                            writer.write_field(text)?;
                        }
                    }
                }
                writer.write_record(None::<&[u8]>)?;
            }
            writer.flush()?;
        }
        file.as_file_mut().flush()?;
        file.as_file().sync_data()?;
        file.persist(self.file(points))?;
        Ok(())
    }

    /// Reads the columns of a part.
    ///
    /// # Errors
    /// [`PartError`] if the file is damaged or cannot be read.
    pub fn read(&self, points: &Range<u64>) -> Result<Vec<Column>, PartError> {
        let file = self.file(points);
        let refuse = |why: String| PartError {
            file: file.clone(),
            why,
        };
        let rows = usize::try_from(points.end - points.start)
            .map_err(|_| refuse("too long".to_owned()))?;
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .has_headers(false)
            .from_reader(input::open(&file).map_err(|e| refuse(e.to_string()))?);
        let mut columns = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| refuse(e.to_string()))?;
            let (Some(name), Some(kind)) = (record.get(0), record.get(1).and_then(Kind::of)) else {
                return Err(refuse("a record without a name and a kind".to_owned()));
            };
            let mut texts: Vec<_> = record.iter().skip(2).map(str::to_owned).collect();
            let cells = match (texts.len(), rows) {
                (count, rows) if count == rows => Cells::Each(texts),
                (1, _) => Cells::Constant(texts.swap_remove(0)),
                (count, _) => {
                    return Err(refuse(format!("{name} has {count} cells for {rows} rows")));
                }
            };
            columns.push(Column {
                name: name.to_owned(),
                kind,
                cells,
            });
        }
        if columns.is_empty() {
            return Err(refuse("it is empty".to_owned()));
        }
        Ok(columns)
    }

    /// Copies the parts of another folder, each whole or not at all.
    ///
    /// # Errors
    /// If a part cannot be read or written.
    pub fn copy_from(&self, other: &Self) -> io::Result<()> {
        for points in other.points()? {
            let mut copy = scratch_file(&self.folder)?;
            io::copy(
                &mut input::open(&other.file(&points)).map_err(io::Error::from)?,
                &mut copy,
            )?;
            copy.as_file().sync_data()?;
            copy.persist(self.file(&points))?;
        }
        Ok(())
    }

    /// Removes the folder with all parts.
    ///
    /// # Errors
    /// If the folder cannot be removed.
    pub fn remove(&self) -> io::Result<()> {
        match fs::remove_dir_all(&self.folder) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
            outcome => outcome,
        }
    }
}

/// Parses the points from the name of a part.
fn points_of(name: &str) -> Option<Range<u64>> {
    let (first, end) = name.strip_suffix(".csv")?.split_once('-')?;
    let points = first.parse().ok()?..end.parse().ok()?;
    (points.start < points.end).then_some(points)
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
mod tests {
    use super::*;
    use crate::row::Cell;

    fn row(index: u64) -> Row {
        let mut cells = vec![
            ("same".to_owned(), Cell::Number(0.1)),
            (
                "count".to_owned(),
                Cell::Whole(-7 * i64::try_from(index).unwrap()),
            ),
            (
                "a, \"quoted\"".to_owned(),
                Cell::Text(format!("x\n{index}")),
            ),
        ];
        if index % 2 == 1 {
            cells.push(("odd".to_owned(), Cell::Number(f64::NAN)));
        }
        Row { index, cells }
    }

    #[test]
    fn what_is_written_is_read_and_neighbours_share_a_part() {
        let home = tempfile::tempdir().unwrap();
        let parts = Parts::in_folder(home.path().to_owned());
        assert!(parts.points().unwrap().is_empty());
        let rows: Vec<_> = [4, 5, 6, 9, 2].map(row).into();
        parts.write(&rows).unwrap();
        assert_eq!(parts.points().unwrap(), [2..3, 4..7, 9..10]);
        let columns = parts.read(&(4..7)).unwrap();
        assert_eq!(columns[0].cells, Cells::Constant("0.1".to_owned()));
        assert_eq!(columns[1].cells.get(2), "-42");
        assert_eq!(columns[2].cells.get(1), "x\n5");
        assert_eq!(
            columns[3].cells,
            Cells::Each(["", "NaN", ""].map(str::to_owned).into())
        );
        parts.remove().unwrap();
        assert!(parts.points().unwrap().is_empty());
    }

    #[test]
    fn gaps_are_what_is_missing() {
        type Points<'a> = &'a [(u64, u64)];
        let ranges = |points: Points<'_>| -> Vec<Range<u64>> {
            points.iter().map(|&(start, end)| start..end).collect()
        };
        let cases: [(Points<'_>, Points<'_>); 5] = [
            (&[], &[(10, 20)]),
            (&[(0, 30)], &[]),
            (&[(10, 12), (12, 13), (15, 16)], &[(13, 15), (16, 20)]),
            (&[(0, 11), (5, 12), (19, 25)], &[(12, 19)]),
            (&[(0, 5), (25, 30)], &[(10, 20)]),
        ];
        for (there, gaps) in cases {
            assert_eq!(missing(10..20, &ranges(there)), ranges(gaps), "{there:?}");
        }
    }

    #[test]
    fn a_damaged_part_is_told() {
        let home = tempfile::tempdir().unwrap();
        let parts = Parts::in_folder(home.path().to_owned());
        let damaged = [
            ("", "empty"),
            ("a,number,1,2\n", "2 cells for 3 rows"),
            ("a\n", "without a name"),
            ("a,colour,1,2,3\n", "without a name"),
        ];
        for (text, word) in damaged {
            fs::write(parts.file(&(0..3)), text).unwrap();
            let error = parts.read(&(0..3)).unwrap_err().to_string();
            assert!(
                error.contains(word) && error.contains("0000000003.csv"),
                "{error}"
            );
        }
    }
}

//! Reading of a recording.

use crate::recorder::sidecar_path;
use crate::row::{COLUMNS, Row, RowError};
use crate::sidecar::{FORMAT, Sidecar};
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Errors of reading.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The JSON file is missing.
    #[error(
        "{0} is missing: expected a CSV file with a JSON file of the same name beside it, as \
         `crepitus record` writes them"
    )]
    NoSidecar(PathBuf),
    /// The JSON file is invalid.
    #[error("{path}: invalid JSON file of a recording: {source}")]
    Sidecar {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// The format is unknown, of a later version.
    #[error("{path}: expected format {FORMAT}, got {found}: use a newer version of crepitus")]
    Format {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u32,
    },
    /// The header of the CSV file is wrong.
    #[error("{0}: not the CSV file of a recording: its header does not match")]
    Header(PathBuf),
    /// A line is invalid.
    #[error("{path}:{line}: {source}")]
    Row {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong with it.
        source: RowError,
    },
}

/// A recording.
#[derive(Clone, Debug)]
pub struct Recording {
    path: PathBuf,
    sidecar: Sidecar,
}

impl Recording {
    /// Opens the recording of a CSV file, or of its JSON file.
    ///
    /// # Errors
    /// [`ReadError`] if there is none.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let path = path.with_extension("csv");
        let json = sidecar_path(&path);
        let text = std::fs::read_to_string(&json).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound if path.exists() => ReadError::NoSidecar(json.clone()),
            _ => ReadError::Io {
                path: json.clone(),
                source,
            },
        })?;
        let sidecar: Sidecar =
            serde_json::from_str(&text).map_err(|source| ReadError::Sidecar {
                path: json.clone(),
                source,
            })?;
        if sidecar.format != FORMAT {
            return Err(ReadError::Format {
                path: json,
                found: sidecar.format,
            });
        }
        Ok(Self { path, sidecar })
    }

    /// The metadata.
    pub fn sidecar(&self) -> &Sidecar {
        &self.sidecar
    }

    /// Its samples in order. An incomplete last line is left out.
    ///
    /// # Errors
    /// [`ReadError`] if the CSV file is not that of a recording.
    pub fn rows(&self) -> Result<Rows, ReadError> {
        let file = File::open(&self.path).map_err(|source| ReadError::Io {
            path: self.path.clone(),
            source,
        })?;
        let mut rows = Rows {
            path: self.path.clone(),
            file: BufReader::with_capacity(1 << 16, file),
            text: String::new(),
            line: 0,
        };
        let header: Vec<_> = COLUMNS.iter().map(|(name, _)| *name).collect();
        match rows.next_line() {
            Some(Ok(())) if rows.text == header.join(",") => Ok(rows),
            Some(Err(error)) => Err(error),
            _ => Err(ReadError::Header(self.path.clone())),
        }
    }
}

/// The samples of a recording.
#[derive(Debug)]
pub struct Rows {
    path: PathBuf,
    file: BufReader<File>,
    text: String,
    line: u64,
}

impl Rows {
    /// The next whole line, without its end, in `text`.
    fn next_line(&mut self) -> Option<Result<(), ReadError>> {
        self.text.clear();
        match self.file.read_line(&mut self.text) {
            Ok(0) => None,
            Ok(_) => {
                self.line += 1;
                // Without a newline it is incomplete.
                self.text.pop().filter(|end| *end == '\n').map(|_| Ok(()))
            }
            Err(source) => Some(Err(ReadError::Io {
                path: self.path.clone(),
                source,
            })),
        }
    }
}

impl Iterator for Rows {
    type Item = Result<Row, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.next_line()? {
            Ok(()) => Some(Row::parse(&self.text).map_err(|source| ReadError::Row {
                path: self.path.clone(),
                line: self.line,
                source,
            })),
            Err(error) => Some(Err(error)),
        }
    }
}

//! Folder of a sweep: identity (`sweep.json`), rows so far (`parts`), the table.

use crate::parts::{Parts, missing, scratch_file};
use crate::plan::Identity;
use crate::row::Row;
use crate::table::{self, Format, TableError, Written};
use crate::traced::Traces;
use crepitus_files::input;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Interval of writing rows: as much is lost of a sweep that is killed.
const FLUSH_AFTER: Duration = Duration::from_secs(2);

/// Most rows that are held in memory.
const FLUSH_ROWS: usize = 8192;

const ABOUT: &str = "sweep.json";
const PARTS: &str = "parts";
const TRACES: &str = "traces";

/// Folder of a sweep.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    about: About,
    parts: Parts,
    /// Rows that are in no part yet.
    rows: BTreeMap<u64, Row>,
    flushed: Instant,
}

/// Content of `sweep.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct About {
    #[serde(flatten)]
    identity: Identity,
    /// The table, once it is complete.
    table: Option<Finished>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Finished {
    file: String,
    failed: u64,
}

/// Error of the folder of a sweep.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder has no sweep.
    #[error("{}: this is not the folder of a sweep: sweep.json is missing", .0.display())]
    None(PathBuf),
    /// `sweep.json` cannot be read.
    #[error("{}: sweep.json is not of this version of the program: {why}", folder.display())]
    Unreadable {
        /// The folder.
        folder: PathBuf,
        /// Reason.
        why: String,
    },
    /// The folder has another sweep.
    #[error("{} has another sweep: {difference}", folder.display())]
    Another {
        /// The folder.
        folder: PathBuf,
        /// Their difference.
        difference: String,
    },
    /// Another program has completed the sweep meanwhile.
    #[error("{}: another program has finished this sweep meanwhile, and its table is there", .0.display())]
    Overtaken(PathBuf),
    /// A file cannot be read or written.
    #[error("{}: {error}", path.display())]
    Io {
        /// Its path.
        path: PathBuf,
        /// The error.
        error: io::Error,
    },
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    move |error| StoreError::Io { path, error }
}

impl Store {
    /// Creates the folder of a sweep, or opens it to resume the sweep.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn create(folder: &Path, identity: &Identity) -> Result<Self, StoreError> {
        match Self::open(folder) {
            Ok(store) => {
                if let Some(difference) = difference(&store.about.identity, identity) {
                    return Err(StoreError::Another {
                        folder: folder.to_owned(),
                        difference,
                    });
                }
                if store.table().is_some() {
                    // Killed between the table and this.
                    store.parts.remove().map_err(at(store.parts.folder()))?;
                } else {
                    fs::create_dir_all(store.parts.folder()).map_err(at(store.parts.folder()))?;
                }
                Ok(store)
            }
            Err(StoreError::None(_)) => {
                let store = Self::new(
                    folder,
                    About {
                        identity: identity.clone(),
                        table: None,
                    },
                );
                fs::create_dir_all(store.parts.folder()).map_err(at(store.parts.folder()))?;
                store.write_about()?;
                Ok(store)
            }
            Err(e) => Err(e),
        }
    }

    /// Opens the folder of a sweep.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        let file = folder.join(ABOUT);
        let read = input::read_to_string(&file, input::TEXT_BYTES).map_err(io::Error::from);
        let text = match read {
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                return Err(StoreError::None(folder.to_owned()));
            }
            text => text.map_err(at(&file))?,
        };
        let about = serde_json::from_str(&text).map_err(|e| StoreError::Unreadable {
            folder: folder.to_owned(),
            why: e.to_string(),
        })?;
        Ok(Self::new(folder, about))
    }

    fn new(folder: &Path, about: About) -> Self {
        Self {
            folder: folder.to_owned(),
            about,
            parts: Parts::in_folder(folder.join(PARTS)),
            rows: BTreeMap::new(),
            flushed: Instant::now(),
        }
    }

    /// Removes the files of a sweep from its folder, and no others.
    ///
    /// # Errors
    /// If a file of it cannot be removed.
    pub fn clear(folder: &Path) -> Result<(), StoreError> {
        let files = [ABOUT, Format::Csv.file(), Format::Parquet.file()];
        for path in files.map(|name| folder.join(name)) {
            match fs::remove_file(&path) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(at(&path)(e)),
                _ => {}
            }
        }
        for path in [PARTS, TRACES].map(|name| folder.join(name)) {
            match fs::remove_dir_all(&path) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(at(&path)(e)),
                _ => {}
            }
        }
        Ok(())
    }

    /// Returns the identity of the sweep.
    pub const fn identity(&self) -> &Identity {
        &self.about.identity
    }

    /// Creates the folder of traces; returns it with the one of incomplete files.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn traces(&self) -> Result<Traces, StoreError> {
        let folder = self.folder.join(TRACES);
        fs::create_dir_all(&folder).map_err(at(&folder))?;
        Ok(Traces {
            folder,
            scratch: self.parts.folder().to_owned(),
        })
    }

    /// Returns the table, if the sweep is complete.
    pub fn table(&self) -> Option<Written> {
        let table = self.about.table.as_ref()?;
        let file = self.folder.join(&table.file);
        Some(Written {
            bytes: fs::metadata(&file).ok()?.len(),
            file,
            failed: table.failed,
        })
    }

    /// Returns the ranges of these points that have no row yet.
    ///
    /// # Errors
    /// If the parts cannot be listed.
    pub fn missing(&self, points: Range<u64>) -> Result<Vec<Range<u64>>, StoreError> {
        let there = self.parts.points().map_err(at(self.parts.folder()))?;
        Ok(missing(points, &there))
    }

    /// Takes a row. Every two seconds, or 8192 rows, the rows become a part.
    ///
    /// # Errors
    /// If a part cannot be written.
    pub fn take(&mut self, row: Row) -> Result<(), StoreError> {
        self.rows.insert(row.index, row);
        if self.rows.len() >= FLUSH_ROWS || self.flushed.elapsed() >= FLUSH_AFTER {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes the rows that are in no part yet.
    ///
    /// # Errors
    /// If a part cannot be written.
    pub fn flush(&mut self) -> Result<(), StoreError> {
        let rows: Vec<_> = std::mem::take(&mut self.rows).into_values().collect();
        self.parts.write(&rows).map_err(|e| {
            if self.parts.folder().exists() {
                at(self.parts.folder())(e)
            } else {
                StoreError::Overtaken(self.folder.clone())
            }
        })?;
        self.flushed = Instant::now();
        Ok(())
    }

    /// Copies the parts of another folder of the same sweep.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn take_parts_of(&self, other: &Self) -> Result<(), StoreError> {
        if let Some(difference) = difference(self.identity(), other.identity()) {
            return Err(StoreError::Another {
                folder: other.folder.clone(),
                difference,
            });
        }
        fs::create_dir_all(self.parts.folder()).map_err(at(self.parts.folder()))?;
        self.parts
            .copy_from(&other.parts)
            .map_err(at(other.parts.folder()))
    }

    /// Writes the table, if every row is there, and removes the parts.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn finish(
        &mut self,
        format: Format,
        progress: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Written, TableError> {
        let written = table::write(&self.parts, self.identity(), &self.folder, format, progress)?;
        self.about.table = Some(Finished {
            file: format.file().to_owned(),
            failed: written.failed,
        });
        self.write_about().map_err(io::Error::other)?;
        self.parts.remove()?;
        Ok(written)
    }

    fn write_about(&self) -> Result<(), StoreError> {
        let path = self.folder.join(ABOUT);
        let write = || -> io::Result<()> {
            let mut file = scratch_file(self.parts.folder())?;
            serde_json::to_writer_pretty(&mut file, &self.about)?;
            file.write_all(b"\n")?;
            file.as_file().sync_all()?;
            file.persist(&path)?;
            Ok(())
        };
        write().map_err(at(&path))
    }
}

/// Describes the first difference of two sweeps.
fn difference(there: &Identity, wanted: &Identity) -> Option<String> {
    if there == wanted {
        return None;
    }
    let pairs = [
        ("version", &there.crepitus_version, &wanted.crepitus_version),
        ("scene", &there.scene, &wanted.scene),
    ];
    for (what, there, wanted) in pairs {
        if there != wanted {
            return Some(format!("its {what} is {there}, not {wanted}"));
        }
    }
    if there.paths != wanted.paths {
        return Some(format!("it varies {}", there.paths.join(", ")));
    }
    if there.runs != wanted.runs {
        return Some(format!("it has {} runs, not {}", there.runs, wanted.runs));
    }
    if there.design_seed != wanted.design_seed {
        return Some("its points have another seed".to_owned());
    }
    Some("another scene text, recording, value or override".to_owned())
}

#[cfg(test)]
pub(crate) mod tests;

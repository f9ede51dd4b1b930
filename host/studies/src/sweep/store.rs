//! Folder of a sweep: identity (`sweep.json`), rows so far (`parts`), the table.

use crate::sweep::parts::{Parts, missing};
use crate::sweep::plan::{Identity, Shard};
use crate::sweep::recipe::Recipe;
use crate::sweep::row::Row;
use crate::sweep::running::Running;
use crate::sweep::store_error::{StoreError, at};
use crate::sweep::table::{self, Content, Format, TableError, Written};
use crate::sweep::traced::Traces;
use crepitus_files::input;
use crepitus_files::output::{Claim, Hashed, OwnedFolder, State, check_folder, lock_folder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};
use tempfile::NamedTempFile;

/// Interval of writing rows: as much is lost of a sweep that is killed.
const FLUSH_AFTER: Duration = Duration::from_secs(2);

/// Most rows that are held in memory.
const FLUSH_ROWS: usize = 8192;

const ABOUT: &str = "sweep.json";
pub(super) const POINTS: &str = "points.csv";
const PARTS: &str = "parts";
const TRACES: &str = "traces";

/// Folder of a sweep.
#[derive(Debug)]
pub struct Store {
    folder: OwnedFolder,
    about: About,
    parts: Parts,
    /// Rows that are in no part yet.
    rows: BTreeMap<u64, Row>,
    flushed: Instant,
    /// None of a sweep that is complete, or whose rows are only read.
    running: Option<Running>,
}

/// Manner in which a sweep's folder is opened for writing.
#[derive(Clone, Debug)]
pub struct Opening {
    /// Shard that is run.
    pub shard: Shard,
    /// Format of the table in the end.
    pub format: Format,
    /// The runs leave their traces.
    pub traces: bool,
    /// Files that may be replaced.
    pub claim: Claim,
}

/// Content of `sweep.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct About {
    #[serde(flatten)]
    pub(super) identity: Identity,
    #[serde(flatten)]
    pub(super) recipe: Recipe,
    /// The table, once it is complete.
    pub(super) table: Option<Finished>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Finished {
    pub(super) file: String,
    failed: u64,
    pub(super) sha256: String,
}

impl Store {
    /// Creates the folder of a sweep, or opens it to resume the sweep, and locks the points of the shard.
    ///
    /// # Errors
    /// [`StoreError`]; whatever is in the way stays as it is.
    pub fn create(
        folder: &Path,
        identity: &Identity,
        recipe: &Recipe,
        opening: &Opening,
    ) -> Result<Self, StoreError> {
        let points = recipe.design.points();
        let names = [ABOUT, opening.format.file()];
        let names = names.into_iter().chain(points.map(|_| POINTS));
        let state = |folder: &OwnedFolder| -> Result<State, StoreError> {
            folder.check(names.clone())?;
            Ok(folder.state(ABOUT)?)
        };
        // Before anything is made.
        check_folder(folder)?;
        if folder.is_dir() {
            let owned = OwnedFolder::open(folder, opening.claim.clone())?;
            if state(&owned)? != State::Own {
                owned.check_subfolder(PARTS)?;
            }
            if opening.traces {
                owned.check_subfolder(TRACES)?;
            }
        }
        fs::create_dir_all(folder).map_err(at(folder))?;
        let _lock = lock_folder(folder);
        let mut owned = OwnedFolder::open(folder, opening.claim.clone())?;
        if state(&owned)? == State::Own {
            let there = read_about(folder);
            let difference = match &there {
                Ok(about) => difference(&about.identity, identity),
                Err(_) => None,
            };
            match (there, difference) {
                (Ok(about), None) => return Self::resume(owned, about, opening),
                _ if opening.claim.force => Self::clear(&mut owned)?,
                (_, Some(difference)) => {
                    let folder = folder.to_owned();
                    return Err(StoreError::Another { folder, difference });
                }
                (Err(error), None) => return Err(error),
            }
        } else {
            owned.check_subfolder(PARTS)?;
        }
        let about = About {
            identity: identity.clone(),
            recipe: recipe.clone(),
            table: None,
        };
        let mut store = Self::new(owned, about, opening.shard);
        if let Some(points) = points {
            store.write(POINTS, |file| points.write(file))?;
        }
        store.write_about()?;
        store.run(opening.shard.points(identity.runs))?;
        Ok(store)
    }

    fn resume(owned: OwnedFolder, about: About, opening: &Opening) -> Result<Self, StoreError> {
        let mut store = Self::new(owned, about, opening.shard);
        if store.has_own_table(opening.claim.force)? {
            // Killed between the table and this.
            store.remove_parts()?;
        } else {
            store.run(opening.shard.points(store.identity().runs))?;
        }
        Ok(store)
    }

    /// Returns whether the sweep has its table, as it was written. One that was removed, or with `force`
    /// changed, is made again.
    fn has_own_table(&mut self, force: bool) -> Result<bool, StoreError> {
        let Some(table) = &self.about.table else {
            return Ok(false);
        };
        if self.folder.state(&table.file)? == State::Own {
            return Ok(true);
        }
        if !force {
            self.folder.check([&table.file])?;
        }
        self.about.table = None;
        Ok(false)
    }

    /// Opens the folder of a sweep whose shards have been run, to make their table.
    ///
    /// # Errors
    /// [`StoreError`]; whatever is in the way stays as it is.
    pub fn open(folder: &Path, format: Format, claim: Claim) -> Result<Self, StoreError> {
        let about = read_about(folder)?;
        let _lock = lock_folder(folder);
        let force = claim.force;
        let owned = OwnedFolder::open(folder, claim)?;
        owned.check([ABOUT])?;
        let mut store = Self::new(owned, about, Shard::WHOLE);
        if !store.has_own_table(force)? {
            store.folder.check([format.file()])?;
            store.run(0..store.identity().runs)?;
        }
        Ok(store)
    }

    /// Opens the folder of a sweep for its rows alone.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn read(folder: &Path) -> Result<Self, StoreError> {
        let about = read_about(folder)?;
        let owned = OwnedFolder::open(folder, Claim::default())?;
        Ok(Self::new(owned, about, Shard::WHOLE))
    }

    fn new(folder: OwnedFolder, about: About, shard: Shard) -> Self {
        let parts = Parts::of(folder.path().join(PARTS), &about.identity, shard);
        Self {
            folder,
            about,
            parts,
            rows: BTreeMap::new(),
            flushed: Instant::now(),
            running: None,
        }
    }

    /// Makes the folder of parts and locks these points. The caller has locked the folder.
    fn run(&mut self, points: Range<u64>) -> Result<(), StoreError> {
        let parts = self.folder.subfolder(PARTS)?;
        let begun = Running::begin(parts.path(), &points).map_err(at(parts.path()))?;
        match begun {
            Ok(running) => self.running = Some(running),
            Err(points) => {
                return Err(StoreError::Running {
                    folder: self.folder.path().to_owned(),
                    points,
                });
            }
        }
        Ok(())
    }

    /// Removes the files of a sweep, and no others.
    fn clear(folder: &mut OwnedFolder) -> Result<(), StoreError> {
        let about = read_about(folder.path());
        if let Ok(About { identity, .. }) = &about {
            let parts = Parts::of(folder.path().join(PARTS), identity, Shard::WHOLE);
            if folder.subfolder_state(PARTS)? == State::Own {
                let running = Running::begin(parts.folder(), &(0..identity.runs));
                if let Err(points) = running.map_err(at(parts.folder()))? {
                    let folder = folder.path().to_owned();
                    return Err(StoreError::Running { folder, points });
                }
                parts.remove().map_err(at(parts.folder()))?;
                folder.subfolder(PARTS)?.remove_own()?;
            }
        }
        if folder.subfolder_state(TRACES)? == State::Own {
            folder.subfolder(TRACES)?.remove_own()?;
        }
        for name in [ABOUT, POINTS, Format::Csv.file(), Format::Parquet.file()] {
            folder.remove(name)?;
        }
        Ok(())
    }

    /// Returns the identity of the sweep.
    pub const fn identity(&self) -> &Identity {
        &self.about.identity
    }

    /// Returns the commit of the program that began the sweep, if it is known.
    pub fn commit(&self) -> Option<&str> {
        self.about.recipe.crepitus_commit.as_deref()
    }

    /// Returns the rows that there are: those of the table, or of the parts.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn content(&self) -> Result<Content, TableError> {
        match &self.about.table {
            Some(table) => table::read(&self.folder.path().join(&table.file)),
            None => table::of_parts(&self.parts, self.identity()),
        }
    }

    /// Opens the folder of traces, for those of these points.
    ///
    /// # Errors
    /// If it cannot be made, or something is in the way.
    pub fn traces(&self, points: &[Range<u64>]) -> Result<Traces, StoreError> {
        Traces::open(self.folder.subfolder(TRACES)?, points)
    }

    /// Returns the table, if the sweep is complete.
    pub fn table(&self) -> Option<Written> {
        let table = self.about.table.as_ref()?;
        let file = self.folder.path().join(&table.file);
        Some(Written {
            bytes: fs::metadata(&file).ok()?.len(),
            file,
            failed: table.failed,
            doubled: 0,
            sha256: table.sha256.clone(),
        })
    }

    /// Returns the ranges of these points that have no row yet.
    ///
    /// # Errors
    /// If a part is not as it was written, or they cannot be read.
    pub fn missing(&self, points: Range<u64>) -> Result<Vec<Range<u64>>, StoreError> {
        let there = self.parts.verified().map_err(at(self.parts.folder()))?;
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
                StoreError::Overtaken(self.folder.path().to_owned())
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
                folder: other.folder.path().to_owned(),
                difference,
            });
        }
        self.parts
            .copy_from(&other.parts)
            .map_err(at(other.parts.folder()))
    }

    /// Writes the table, if every row is there, reads it back, and removes the parts.
    ///
    /// # Errors
    /// [`TableError`]; the parts stay then.
    pub fn finish(
        &mut self,
        format: Format,
        progress: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Written, TableError> {
        let name = format.file();
        self.folder.check([name])?;
        let table = table::write(&self.parts, self.identity(), format, progress)?;
        let _lock = lock_folder(self.folder.path());
        let file = Hashed::of(table.file.into_temp_path())?;
        let sha256 = file.sha256().to_owned();
        self.folder.put(file, name)?;
        self.about.table = Some(Finished {
            file: name.to_owned(),
            failed: table.failed,
            sha256: sha256.clone(),
        });
        self.write_about().map_err(io::Error::other)?;
        self.remove_parts().map_err(io::Error::other)?;
        Ok(Written {
            file: self.folder.path().join(name),
            bytes: table.bytes,
            failed: table.failed,
            doubled: table.doubled,
            sha256,
        })
    }

    /// Removes the parts, and their folder, unless others have files in it.
    fn remove_parts(&mut self) -> Result<(), StoreError> {
        self.parts.remove().map_err(at(self.parts.folder()))?;
        self.running = None;
        if self.folder.subfolder_state(PARTS)? == State::Own {
            self.folder.subfolder(PARTS)?.remove_own()?;
        }
        Ok(())
    }

    fn write_about(&mut self) -> Result<(), StoreError> {
        let about = self.about.clone();
        self.write(ABOUT, |file| {
            serde_json::to_writer_pretty(&mut *file, &about)?;
            file.write_all(b"\n")
        })?;
        Ok(self.folder.compact()?)
    }

    /// Writes a file of the folder, whole or not at all.
    fn write(
        &mut self,
        name: &str,
        content: impl FnOnce(&mut NamedTempFile) -> io::Result<()>,
    ) -> Result<(), StoreError> {
        let write = || -> io::Result<Hashed> {
            let mut file = self.folder.temporary()?;
            content(&mut file)?;
            file.as_file().sync_all()?;
            Hashed::of(file.into_temp_path())
        };
        let file = write().map_err(at(&self.folder.path().join(name)))?;
        Ok(self.folder.put(file, name)?)
    }
}

/// Reads `sweep.json`.
pub(super) fn read_about(folder: &Path) -> Result<About, StoreError> {
    let file = folder.join(ABOUT);
    let text = match fs::symlink_metadata(&file) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return Err(StoreError::None(folder.to_owned()));
        }
        Ok(entry) if !entry.is_file() => {
            return Err(StoreError::Unreadable {
                folder: folder.to_owned(),
                why: "it is not a regular file".to_owned(),
            });
        }
        entry => entry
            .and_then(|_| Ok(input::read_to_string(&file, input::TEXT_BYTES)?))
            .map_err(at(&file))?,
    };
    serde_json::from_str(&text).map_err(|e| StoreError::Unreadable {
        folder: folder.to_owned(),
        why: e.to_string(),
    })
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

//! Folder into which files are written one by one.

use super::marker::{self, ListState, Marker, is_plain, kind};
use super::{Claim, InTheWay, MARKER, OutputError, Reason, TEMPORARY, sha256, temporary_in};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, PathPersistError, TempPath};

/// Folder with a list of the files that this program wrote there.
#[derive(Debug)]
pub struct OwnedFolder {
    folder: PathBuf,
    claim: Claim,
    marker: Marker,
    /// The folder has a list. Without one nothing in it is this program's.
    has_list: bool,
    /// Names since the list was compacted: true if a file was written, false if it was removed.
    changed: BTreeMap<String, bool>,
}

/// State of a name in a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// There is nothing of this name.
    Free,
    /// This program wrote the file, under the same claim, and it is unchanged.
    Own,
    /// The name is not replaced without force, or not at all.
    InTheWay(Reason),
}

/// Complete file on its way into a folder.
#[derive(Debug)]
pub struct Hashed {
    pub(super) path: TempPath,
    pub(super) sha256: String,
}

impl Hashed {
    /// Hashes a temporary file, whose content is complete.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of(path: TempPath) -> io::Result<Self> {
        let sha256 = sha256(File::open(&path)?)?;
        Ok(Self { path, sha256 })
    }

    /// Returns the SHA-256 of the content.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

impl OwnedFolder {
    /// Opens a folder.
    ///
    /// # Errors
    /// [`OutputError`] if it cannot be read, or has a list that is not this program's.
    pub fn open(folder: &Path, claim: Claim) -> Result<Self, OutputError> {
        let found = Marker::read(folder).map_err(failed(&folder.join(MARKER), READING))?;
        let (marker, has_list) = match found {
            ListState::None => (Marker::default(), false),
            ListState::Own(marker) => (marker, true),
            ListState::InTheWay(reason) => {
                if !(claim.force && reason.yields_to_force()) {
                    return Err(OutputError::InTheWay {
                        folder: folder.to_owned(),
                        names: vec![InTheWay {
                            name: MARKER.to_owned(),
                            reason,
                        }],
                        has_list: true,
                    });
                }
                (Marker::default(), false)
            }
        };
        Ok(Self {
            folder: folder.to_owned(),
            claim,
            marker,
            has_list,
            changed: BTreeMap::new(),
        })
    }

    /// Opens a folder inside, which is made if there is nothing of this name.
    ///
    /// # Errors
    /// [`OutputError`] if something is there that is no folder of this program; a link is none.
    pub fn subfolder(&self, name: &str) -> Result<Self, OutputError> {
        let path = self.folder.join(name);
        let made = || -> io::Result<()> {
            let parts = tempfile::Builder::new()
                .prefix(TEMPORARY)
                .tempdir_in(&self.folder)?;
            let new = parts.path().join("new");
            fs::create_dir(&new)?;
            Marker::default().write(&new)?;
            fs::rename(new, &path)
        };
        if self.subfolder_state(name)? == State::Free {
            match made() {
                // Another run of this program was quicker.
                Err(_) if fs::symlink_metadata(&path).is_ok() => {}
                made => made.map_err(failed(&path, "cannot be created"))?,
            }
        }
        self.check_subfolder(name)?;
        Self::open(&path, self.claim.clone())
    }

    /// Returns the state of a name that is to be a folder: one of this program's has a list.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn subfolder_state(&self, name: &str) -> Result<State, OutputError> {
        let path = self.folder.join(name);
        let metadata = match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(State::Free),
            metadata => metadata.map_err(failed(&path, READING))?,
        };
        Ok(match kind(&metadata) {
            Some(Reason::Folder) => {
                let found = Marker::read(&path).map_err(failed(&path, READING))?;
                match found {
                    ListState::Own(_) => State::Own,
                    _ => State::InTheWay(Reason::Folder),
                }
            }
            Some(Reason::Special) => State::InTheWay(Reason::Special),
            _ => State::InTheWay(Reason::NoFolder),
        })
    }

    /// Checks that a folder of this name can be made, or is this program's.
    ///
    /// # Errors
    /// [`OutputError::InTheWay`].
    pub fn check_subfolder(&self, name: &str) -> Result<(), OutputError> {
        match self.subfolder_state(name)? {
            State::InTheWay(reason) => Err(self.in_the_way(vec![InTheWay {
                name: name.to_owned(),
                reason,
            }])),
            State::Own | State::Free => Ok(()),
        }
    }

    /// Returns the path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Returns the state of a name that is to be a file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn state(&self, name: &str) -> Result<State, OutputError> {
        let path = self.folder.join(name);
        let metadata = match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(State::Free),
            metadata => metadata.map_err(failed(&path, READING))?,
        };
        let kind = kind(&metadata);
        // Also behind a link, and under each of its hard links.
        if self.claim.inputs.contains(&path) {
            return Ok(State::InTheWay(Reason::Input));
        }
        if let Some(reason) = kind {
            return Ok(State::InTheWay(reason));
        }
        let written = self.marker.written(name);
        if written.is_empty() {
            return Ok(State::InTheWay(Reason::Foreign));
        }
        let content = File::open(&path).and_then(sha256);
        let content = content.map_err(failed(&path, READING))?;
        let same = written.iter().rev().find(|one| one.sha256 == content);
        Ok(match same {
            None => State::InTheWay(Reason::Changed),
            Some(one) if one.by == self.claim.by => State::Own,
            Some(one) => State::InTheWay(Reason::By(one.by.clone())),
        })
    }

    /// Checks that files of these names can be written.
    ///
    /// # Errors
    /// [`OutputError::InTheWay`] with all that are in the way.
    pub fn check<N: AsRef<str>>(
        &self,
        names: impl IntoIterator<Item = N>,
    ) -> Result<(), OutputError> {
        let mut in_the_way = Vec::new();
        for name in names {
            let name = name.as_ref();
            if let State::InTheWay(reason) = self.state(name)? {
                in_the_way.push(InTheWay {
                    name: name.to_owned(),
                    reason,
                });
            }
        }
        self.unless_forced(in_the_way)
    }

    fn unless_forced(&self, mut names: Vec<InTheWay>) -> Result<(), OutputError> {
        names.sort_by(|a, b| a.name.cmp(&b.name));
        let would_stay = |name: &InTheWay| !(self.claim.force && name.reason.yields_to_force());
        let names: Vec<_> = names.into_iter().filter(would_stay).collect();
        if names.is_empty() {
            Ok(())
        } else {
            Err(self.in_the_way(names))
        }
    }

    fn in_the_way(&self, names: Vec<InTheWay>) -> OutputError {
        OutputError::InTheWay {
            folder: self.folder.clone(),
            names,
            has_list: self.has_list,
        }
    }

    /// Creates a temporary file on the folder's file system.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn temporary(&self) -> io::Result<NamedTempFile> {
        temporary_in(&self.folder)
    }

    /// Puts a file into its place.
    ///
    /// # Errors
    /// [`OutputError`]; whatever is in the way stays as it is.
    pub fn put(&mut self, file: Hashed, name: &str) -> Result<(), OutputError> {
        self.put_all(vec![(name.to_owned(), file)])
    }

    /// Puts files into their places; none, if something is in the way of one of them.
    ///
    /// # Errors
    /// [`OutputError`]; whatever is in the way stays as it is.
    pub fn put_all(&mut self, files: Vec<(String, Hashed)>) -> Result<(), OutputError> {
        self.check(files.iter().map(|(name, _)| name))?;
        let lines: Vec<_> = (files.iter())
            .map(|(name, file)| (name.as_str(), file.sha256.as_str()))
            .collect();
        let listing = failed(&self.folder.join(MARKER), WRITING);
        if !self.has_list {
            self.marker.write(&self.folder).map_err(&listing)?;
            self.has_list = true;
        }
        marker::append(&self.folder, &self.claim.by, &lines).map_err(&listing)?;
        for (name, sha256) in lines {
            debug_assert!(is_plain(name), "{name}");
            self.marker.add(name, sha256, &self.claim.by);
        }
        for (name, file) in files {
            self.place(file.path, &name)?;
        }
        Ok(())
    }

    fn place(&mut self, file: TempPath, name: &str) -> Result<(), OutputError> {
        let path = self.folder.join(name);
        let moved = match self.state(name)? {
            State::Free => file.persist_noclobber(&path),
            State::Own => file.persist(&path),
            State::InTheWay(reason) => {
                self.unless_forced(vec![InTheWay {
                    name: name.to_owned(),
                    reason,
                }])?;
                file.persist(&path)
            }
        };
        if let Err(PathPersistError { error, path: file }) = moved {
            if error.kind() != io::ErrorKind::AlreadyExists {
                return Err(failed(&path, WRITING)(error));
            }
            // Something came meanwhile: the same file of another run of this program, or a foreign one.
            if let State::InTheWay(reason) = self.state(name)? {
                return Err(self.in_the_way(vec![InTheWay {
                    name: name.to_owned(),
                    reason,
                }]));
            }
            let moved = file.persist(&path);
            moved.map_err(|error| failed(&path, WRITING)(error.error))?;
        }
        self.changed.insert(name.to_owned(), true);
        Ok(())
    }

    /// Writes the list without what has been replaced or removed; lines that another run of this program
    /// has added meanwhile stay. The caller has locked the folder, if several may write.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn compact(&mut self) -> Result<(), OutputError> {
        let list = self.folder.join(MARKER);
        if let ListState::Own(marker) =
            Marker::read(&self.folder).map_err(failed(&list, READING))?
        {
            self.marker = marker;
        }
        for (name, is_written) in std::mem::take(&mut self.changed) {
            if is_written {
                self.marker.keep_last(&name);
            } else {
                self.marker.forget(&name);
            }
        }
        self.marker
            .write(&self.folder)
            .map_err(failed(&list, WRITING))
    }

    /// Removes a file, if it is this program's own; returns whether the name is free then.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(&mut self, name: &str) -> Result<bool, OutputError> {
        match self.state(name)? {
            State::Free => {}
            State::Own => {
                let path = self.folder.join(name);
                fs::remove_file(&path).map_err(failed(&path, REMOVING))?;
            }
            State::InTheWay(_) => return Ok(false),
        }
        self.marker.forget(name);
        self.changed.insert(name.to_owned(), false);
        Ok(true)
    }

    /// Removes all own files and the list, and the folder if nothing else is in it.
    ///
    /// # Errors
    /// If something cannot be removed.
    pub fn remove_own(mut self) -> Result<(), OutputError> {
        let names: Vec<_> = self.marker.names().map(str::to_owned).collect();
        for name in &names {
            self.remove(name)?;
        }
        if self.marker.names().next().is_some() {
            return self.compact();
        }
        let list = self.folder.join(MARKER);
        let removed = if self.has_list {
            fs::remove_file(&list)
        } else {
            Ok(())
        };
        removed.map_err(failed(&list, REMOVING))?;
        match fs::remove_dir(&self.folder) {
            // Files of others.
            Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Ok(()),
            removed => removed.map_err(failed(&self.folder, REMOVING)),
        }
    }
}

const READING: &str = "cannot be read";
const WRITING: &str = "cannot be written";
const REMOVING: &str = "cannot be removed";

pub(super) fn failed(
    path: &Path,
    doing: &'static str,
) -> impl Fn(io::Error) -> OutputError + use<> {
    let path = path.to_owned();
    move |source| OutputError::Io {
        path: path.clone(),
        doing,
        source,
    }
}

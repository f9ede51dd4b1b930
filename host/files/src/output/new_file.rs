//! A single file, or standard output.

use super::marker::kind;
use super::owned::failed;
use super::{Inputs, OutputError, Reason, folder_of, sync_folder_of, temporary_in};
use std::fs::{self, File};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// File that appears whole or not at all. One that exists is replaced only with force: a single file
/// has no list that would prove whose it is.
#[derive(Debug)]
pub struct NewFile {
    /// None for standard output.
    target: Option<PathBuf>,
    file: NamedTempFile,
    force: bool,
}

/// Returns whether a path names standard output.
#[must_use]
pub fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]
        .iter()
        .any(|name| path == Path::new(name))
}

impl NewFile {
    /// Prepares a file, before the work, so that what is in the way ends it early.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn create(path: &Path, force: bool, inputs: &Inputs) -> Result<Self, OutputError> {
        if is_stdout(path) {
            let file = NamedTempFile::new();
            return Ok(Self {
                target: None,
                file: file.map_err(failed(&std::env::temp_dir(), CREATING))?,
                force,
            });
        }
        if let Some(reason) = in_the_way(path, force, inputs) {
            return Err(error_of(path, reason));
        }
        let file = temporary_in(folder_of(path)).map_err(failed(path, CREATING))?;
        Ok(Self {
            target: Some(path.to_owned()),
            file,
            force,
        })
    }

    /// Returns the file to write to.
    #[must_use]
    pub fn as_file(&self) -> &File {
        self.file.as_file()
    }

    /// Returns whether the content goes to standard output.
    #[must_use]
    pub const fn is_stdout(&self) -> bool {
        self.target.is_none()
    }

    /// Moves the complete file into its place, or copies it to standard output.
    ///
    /// # Errors
    /// [`OutputError`]; what came into the way meanwhile stays as it is.
    pub fn persist(self) -> Result<(), OutputError> {
        let Some(path) = self.target else {
            return to_stdout(self.file.into_file()).map_err(failed(Path::new("-"), WRITING));
        };
        let moved = if self.force {
            self.file.persist(&path)
        } else {
            self.file.persist_noclobber(&path)
        };
        moved.map_err(|error| match error.error.kind() {
            io::ErrorKind::AlreadyExists => error_of(&path, Reason::Foreign),
            _ => failed(&path, WRITING)(error.error),
        })?;
        sync_folder_of(&path).map_err(failed(&path, WRITING))
    }
}

fn to_stdout(mut file: File) -> io::Result<()> {
    file.rewind()?;
    let mut out = io::stdout().lock();
    io::copy(&mut file, &mut out)?;
    out.flush()
}

const CREATING: &str = "cannot be created";
const WRITING: &str = "cannot be written";

/// Reason why a path cannot be written.
fn in_the_way(path: &Path, force: bool, inputs: &Inputs) -> Option<Reason> {
    let metadata = fs::symlink_metadata(path).ok()?;
    if inputs.contains(path) {
        return Some(Reason::Input);
    }
    match kind(&metadata) {
        Some(reason @ (Reason::Folder | Reason::Special)) => Some(reason),
        _ if force => None,
        Some(reason) => Some(reason),
        None => Some(Reason::Foreign),
    }
}

fn error_of(path: &Path, reason: Reason) -> OutputError {
    OutputError::Exists {
        path: path.to_owned(),
        reason,
    }
}

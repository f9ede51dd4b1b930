//! Errors of the folder of a sweep.

use crepitus_files::output::OutputError;
use crepitus_scene::SceneError;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

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
    /// A file that repeats the sweep is not as it was.
    #[error("{}: {why}", folder.display())]
    Changed {
        /// The folder.
        folder: PathBuf,
        /// Reason.
        why: String,
    },
    /// The scene of the sweep cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The folder has another sweep.
    #[error("{} has another sweep: {difference}", folder.display())]
    Another {
        /// The folder.
        folder: PathBuf,
        /// Their difference.
        difference: String,
    },
    /// Another program is running points of the sweep in this folder.
    #[error("{}: another program is running points {} to {} of this sweep in this folder", folder.display(),
            points.start, points.end.saturating_sub(1))]
    Running {
        /// The folder.
        folder: PathBuf,
        /// Points that the other program is running.
        points: Range<u64>,
    },
    /// Something is in the way.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Another program has completed the sweep meanwhile.
    #[error("{}: another program has finished this sweep meanwhile, and its table is there", .0.display())]
    Overtaken(PathBuf),
    /// A file cannot be read or written.
    #[error("{}: {error}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// The error.
        error: io::Error,
    },
}

/// Returns an error of reading or writing this file.
pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    move |error| StoreError::Io { path, error }
}

//! Files that are written: whole or not at all, and never over those of others.
//!
//! ```text
//! Folder ──┐ many files at once          ┌─> Free       written, never over what came meanwhile
//!          ├─> OwnedFolder ─> Marker ────┼─> Own        replaced, removed
//! Sweeps ──┘ file by file                └─> in the way an error that names it
//! NewFile    a single file, or standard output
//! ```
//!
//! A folder into which this program writes holds a list of its files, [`MARKER`]: name, SHA-256, and
//! the verb that wrote it. A file is this program's own while it is regular, writable, on the list, and
//! its bytes have the hash there. Everything else is foreign: files of people, of other programs, of
//! versions without the list, files that were changed, links, folders. Foreign files are replaced
//! only with [`Claim::force`], and never removed; an input is not replaced at all.
//!
//! Names are compared as the file system of Linux does; one that ignores case is not provided for.

mod claim;
mod error;
mod folder;
mod inputs;
mod marker;
mod new_file;
mod owned;

pub use claim::Claim;
pub use error::{InTheWay, OutputError, Reason};
pub use folder::{Folder, Part, check_folder};
pub use inputs::Inputs;
pub use marker::MARKER;
pub use new_file::{NewFile, is_stdout};
pub use owned::{Hashed, OwnedFolder, State};

use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use tempfile::NamedTempFile;

/// Prefix of the names of files and folders that are not complete yet.
const TEMPORARY: &str = ".crepitus-";

/// Creates a temporary file in a folder, with the permissions of an ordinary file; it is removed when it is dropped.
///
/// # Errors
/// If it cannot be created.
pub fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    temporary_with_prefix(folder, TEMPORARY)
}

/// Creates a temporary file that only its owner can read; so can only they when it is in its place.
///
/// # Errors
/// If it cannot be created.
pub fn private_in(folder: &Path) -> io::Result<NamedTempFile> {
    // The permissions of temporary files.
    tempfile::Builder::new()
        .prefix(TEMPORARY)
        .tempfile_in(folder)
}

/// Creates a temporary file whose name begins with `prefix`.
///
/// # Errors
/// If it cannot be created.
pub fn temporary_with_prefix(folder: &Path, prefix: &str) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    // The usual permissions, not those of a temporary file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Syncs the folder of a path, so that the file's name outlives a power cut; where folders cannot be
/// opened the system does it.
///
/// # Errors
/// Of the disk.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    match File::open(folder_of(path)) {
        Ok(folder) if cfg!(unix) => folder.sync_all(),
        _ => Ok(()),
    }
}

/// Returns the folder that a path is in.
#[must_use]
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Returns the SHA-256 of everything that is read, in hex digits.
///
/// # Errors
/// Of the reader.
pub fn sha256(mut reader: impl Read) -> io::Result<String> {
    let mut sha = Sha256::new();
    let mut bytes = vec![0; 1 << 16];
    loop {
        match reader.read(&mut bytes) {
            Ok(0) => return Ok(hex(&sha.finalize())),
            Ok(count) => sha.update(bytes.get(..count).unwrap_or_default()),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// Returns lower-case hex digits.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// Locks a folder until the file is dropped, so that another run of this program waits. None where
/// folders cannot be locked, or another program keeps the lock.
#[must_use]
pub fn lock_folder(folder: &Path) -> Option<File> {
    use std::fs::TryLockError;
    use std::time::Duration;
    /// Attempts, 10 ms apart: nobody holds this lock for long.
    const TRIES: u32 = 500;
    let folder = File::open(folder).ok()?;
    for _ in 0..TRIES {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(10)),
            Err(TryLockError::Error(_)) => return None,
        }
    }
    None
}

#[cfg(test)]
mod tests;

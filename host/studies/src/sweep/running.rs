//! Lock of the points that a program is running.
//!
//! Shards run side by side in one folder, so each program locks its points: a file whose name tells them,
//! locked while the program runs, and removed when it ends. One that a killed program has left is not
//! locked, and the next program removes it.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// First bytes of a lock file.
const TEXT: &str = "crepitus sweep: running\n";

/// Points that this program is running, until it is dropped.
#[derive(Debug)]
pub(crate) struct Running {
    path: PathBuf,
    _lock: File,
}

impl Running {
    /// Locks points, or returns those of another program that runs some of them. The caller has locked the
    /// sweep's folder meanwhile.
    pub(crate) fn begin(
        folder: &Path,
        points: &Range<u64>,
    ) -> io::Result<Result<Self, Range<u64>>> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name();
            let Some(theirs) = name.to_str().and_then(points_of) else {
                continue;
            };
            let is_disjoint = theirs.end <= points.start || points.end <= theirs.start;
            if is_disjoint || !is_lock(&entry.path()) {
                continue;
            }
            match File::open(entry.path()).map(|file| file.try_lock()) {
                Ok(Err(TryLockError::WouldBlock)) => return Ok(Err(theirs)),
                // Of a program that has ended just now.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                _ => fs::remove_file(entry.path())?,
            }
        }
        let path = folder.join(name_of(points));
        let mut lock = File::create_new(&path)?;
        lock.write_all(TEXT.as_bytes())?;
        // Where files cannot be locked two programs are not kept apart.
        let _ = lock.try_lock();
        Ok(Ok(Self { path, _lock: lock }))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // The lock may be gone with its folder.
        let _ = fs::remove_file(&self.path);
    }
}

fn name_of(points: &Range<u64>) -> String {
    format!(".running-{:010}-{:010}.lock", points.start, points.end)
}

fn points_of(name: &str) -> Option<Range<u64>> {
    let name = name.strip_prefix(".running-")?.strip_suffix(".lock")?;
    let (first, end) = name.split_once('-')?;
    Some(first.parse().ok()?..end.parse().ok()?)
}

/// Returns whether a file is one of these, and not somebody's own.
fn is_lock(path: &Path) -> bool {
    let is_small = fs::symlink_metadata(path)
        .is_ok_and(|file| file.is_file() && file.len() <= TEXT.len() as u64);
    is_small
        && match fs::read_to_string(path) {
            Ok(text) => TEXT.starts_with(&text),
            // On Windows nobody else can read a file that is locked.
            Err(error) => cfg!(windows) && error.kind() != io::ErrorKind::NotFound,
        }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_run_once_at_a_time() {
        let home = tempfile::tempdir().unwrap();
        let begin = |points: Range<u64>| Running::begin(home.path(), &points).unwrap();
        let first = begin(0..10).unwrap();
        assert_eq!(begin(9..20).unwrap_err(), 0..10);
        let second = begin(10..20).unwrap();
        drop(first);
        assert_eq!(begin(0..100).unwrap_err(), 10..20);
        drop(second);
        // What a killed program has left, and a file that only looks like it.
        fs::write(home.path().join(name_of(&(5..6))), TEXT).unwrap();
        let mine = home.path().join(name_of(&(7..8)));
        fs::write(&mine, "mine").unwrap();
        drop(begin(0..100).unwrap());
        assert_eq!(fs::read_to_string(mine).unwrap(), "mine");
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
    }
}

//! The name of a simulated device: a link to its pty, and a lock that the program
//! holds which serves it.
//!
//! A link alone says nothing: its program may have been killed, and the system
//! may have given the pty to somebody's terminal since.

use super::folder::make_user_folder;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

/// A name that this program serves a simulated device under, until it is
/// dropped.
#[derive(Debug)]
pub struct ServedName {
    link: PathBuf,
    _lock: File,
}

impl ServedName {
    /// Takes a name. The link is the caller's to make; one that is there is of
    /// a program that has ended.
    ///
    /// # Errors
    /// [`io::ErrorKind::AddrInUse`] if another program serves this name; those of
    /// the system.
    pub fn take(name: &str) -> io::Result<Self> {
        // Another program may just be looking.
        const TRIES: u32 = 20;
        let link = make_user_folder()?.join(name);
        let lock = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(lock_of(&link))?;
        for _ in 0..TRIES {
            match lock.try_lock() {
                Ok(()) => {
                    // One that was left may lead to a terminal that is somebody else's by now, and
                    // from here on the lock says that it is ours.
                    if fs::read_link(&link).is_ok_and(|target| target.starts_with("/dev")) {
                        fs::remove_file(&link)?;
                    }
                    return Ok(Self { link, _lock: lock });
                }
                Err(TryLockError::WouldBlock) => sleep(Duration::from_millis(5)),
                Err(TryLockError::Error(error)) => return Err(error),
            }
        }
        Err(io::Error::new(
            io::ErrorKind::AddrInUse,
            "another program serves a device of this name",
        ))
    }

    /// Where the link to the pty belongs.
    pub fn link(&self) -> &Path {
        &self.link
    }
}

/// Whether a program serves a simulated device at this link.
pub(super) fn is_served(link: &Path) -> bool {
    let is_locked = File::open(lock_of(link))
        .is_ok_and(|lock| matches!(lock.try_lock_shared(), Err(TryLockError::WouldBlock)));
    // `exists` follows the link.
    is_locked && link.exists()
}

/// True if there is a lock file: a program serves, or has served, a simulated device at this link.
pub(super) fn has_lock(link: &Path) -> bool {
    lock_of(link).exists()
}

fn lock_of(link: &Path) -> PathBuf {
    let mut path = link.as_os_str().to_owned();
    path.push(".lock");
    PathBuf::from(path)
}

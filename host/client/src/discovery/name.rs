//! The name of a simulated device: a link to its pty, and a lock that the program
//! holds which serves it. The lock's file says where the link leads.
//!
//! A link alone says nothing: its program may have been killed, and the system
//! may have given the pty to somebody's terminal since; or somebody has replaced it.

use super::folder::make_user_folder;
use crepitus_files::input;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

/// A name that this program serves a simulated device under, until it is
/// dropped.
#[derive(Debug)]
pub struct ServedName {
    link: PathBuf,
    lock: File,
}

impl ServedName {
    /// Takes a name. The link is the caller's to make, who [says](Self::publish) where it leads;
    /// one that is there is of a program that has ended.
    ///
    /// # Errors
    /// [`io::ErrorKind::AddrInUse`] if another program serves this name; those of
    /// the system.
    pub fn take(name: &str) -> io::Result<Self> {
        Self::at(make_user_folder()?.join(name))
    }

    fn at(link: PathBuf) -> io::Result<Self> {
        // Another program may just be looking.
        const TRIES: u32 = 20;
        for _ in 0..TRIES {
            let lock = File::options()
                .create(true)
                .truncate(false)
                .write(true)
                .open(lock_of(&link))?;
            match lock.try_lock() {
                // The program before has just removed it.
                Ok(()) if !is_at(&lock, &lock_of(&link)) => {}
                Ok(()) => {
                    // What the program before has said.
                    lock.set_len(0)?;
                    // One that was left may lead to a terminal that is somebody else's by now, and
                    // from here on the lock says that it is ours.
                    if fs::read_link(&link).is_ok_and(|target| target.starts_with("/dev")) {
                        fs::remove_file(&link)?;
                    }
                    return Ok(Self { link, lock });
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

    /// Path at which the link to the pty belongs.
    pub fn link(&self) -> &Path {
        &self.link
    }

    /// Says, once, which pty the link leads to. Before that, and wherever else it leads, others do
    /// not open it.
    ///
    /// # Errors
    /// Those of the system.
    pub fn publish(&self, pty: &Path) -> io::Result<()> {
        (&self.lock).write_all(format!("{}\n", pty.display()).as_bytes())
    }
}

/// Removes the lock's file, as long as it is locked.
impl Drop for ServedName {
    fn drop(&mut self) {
        let path = lock_of(&self.link);
        if cfg!(unix) && is_at(&self.lock, &path) {
            // One that stays behind is taken by the next program.
            let _ = fs::remove_file(path);
        }
    }
}

/// Returns whether this open file is the one at a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |file: io::Result<fs::Metadata>| file.ok().map(|m| (m.dev(), m.ino()));
    let own = identity(file.metadata());
    own.is_some() && own == identity(fs::metadata(path))
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

/// A link with the name of a simulated device that does not lead to it: somebody has replaced it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "this link leads to {}, and the simulated device of this name is at {}; use that port, or \
     remove the link, end `crepitus serve-sim`, and start it again",
    .target.display(),
    .pty.display()
)]
pub struct Elsewhere {
    /// Target that it has.
    pub target: PathBuf,
    /// Target that it should have.
    pub pty: PathBuf,
}

/// Target of the link of a simulated device.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// The device.
    Served,
    /// Not a device of this project: its program has ended, or does not serve yet.
    Ended,
    /// Something else, while its program serves the device.
    Elsewhere(Elsewhere),
}

/// Target of this link.
pub(super) fn standing(link: &Path) -> Standing {
    match (pty_of(link), fs::read_link(link)) {
        (Some(pty), Ok(target)) if target != pty => Standing::Elsewhere(Elsewhere { target, pty }),
        // `exists` follows the link.
        (Some(_), Ok(_)) if link.exists() => Standing::Served,
        _ => Standing::Ended,
    }
}

/// Target that this link should have, if a program serves a simulated device there.
fn pty_of(link: &Path) -> Option<PathBuf> {
    let mut lock = input::open(&lock_of(link)).ok()?;
    if !matches!(lock.try_lock_shared(), Err(TryLockError::WouldBlock)) {
        return None;
    }
    let mut text = String::new();
    lock.read_to_string(&mut text).ok()?;
    // Without its end it is only a part of it.
    text.strip_suffix('\n').map(PathBuf::from)
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

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_link_is_served_while_it_leads_where_its_program_says() {
        let folder = tempfile::tempdir().unwrap();
        let [link, pty, target] = ["knee", "pty", "target"].map(|name| folder.path().join(name));
        for file in [&pty, &target] {
            fs::write(file, "").unwrap();
        }
        // A longer one, of a program that was killed.
        fs::write(lock_of(&link), format!("{}-of-before\n", pty.display())).unwrap();
        symlink(&pty, &link).unwrap();
        assert_eq!(standing(&link), Standing::Ended);
        let served = ServedName::at(link.clone()).unwrap();
        assert_eq!(standing(&link), Standing::Ended);
        served.publish(&pty).unwrap();
        assert_eq!(standing(&link), Standing::Served);
        fs::remove_file(&link).unwrap();
        symlink(&target, &link).unwrap();
        let elsewhere = Elsewhere { target, pty };
        let text = elsewhere.to_string();
        for path in [&elsewhere.target, &elsewhere.pty] {
            assert!(text.contains(path.to_str().unwrap()), "{text}");
        }
        assert_eq!(standing(&link), Standing::Elsewhere(elsewhere));
        // The name is in use all the same.
        let error = ServedName::at(link.clone()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AddrInUse);
        drop(served);
        assert_eq!(standing(&link), Standing::Ended);
        assert!(!lock_of(&link).exists());
    }
}

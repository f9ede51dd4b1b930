//! Sockets of Unix: a path in a folder of this user alone.

use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

/// A connection, in blocking mode.
pub(crate) type Stream = UnixStream;

/// Listens at a path, which it removes in the end.
#[derive(Debug)]
pub(crate) struct Listener {
    socket: UnixListener,
    path: PathBuf,
    /// Device and inode of the path. Nothing else has them as long as this listens.
    identity: (u64, u64),
}

impl Listener {
    /// Listens at `path`. What an earlier program has left there is replaced: the caller has the
    /// lock.
    ///
    /// # Errors
    /// Of the system: the folder is gone, or the path too long for a socket.
    pub(crate) fn at(path: &Path) -> io::Result<Self> {
        // Or an empty folder.
        let _ = fs::remove_file(path).or_else(|_| fs::remove_dir(path));
        let socket = UnixListener::bind(path)?;
        let listener = Self {
            socket,
            path: path.to_owned(),
            identity: identity_of(path)?,
        };
        // The folder is private already.
        fs::set_permissions(path, Permissions::from_mode(0o600))?;
        listener.socket.set_nonblocking(true)?;
        Ok(listener)
    }

    /// Returns whether the path still leads here.
    pub(crate) fn is_found(&self) -> bool {
        identity_of(&self.path).is_ok_and(|found| found == self.identity)
    }

    /// A program that has connected. It does not wait for one.
    ///
    /// # Errors
    /// [`io::ErrorKind::WouldBlock`] if there is none; those of the system, as too many open files.
    pub(crate) fn accept(&self) -> io::Result<Arrival> {
        let (stream, _) = self.socket.accept()?;
        // On macOS it is as the listener is.
        stream.set_nonblocking(false)?;
        Ok(Arrival(stream))
    }
}

/// Device and inode.
fn identity_of(path: &Path) -> io::Result<(u64, u64)> {
    let found = fs::symlink_metadata(path)?;
    Ok((found.dev(), found.ino()))
}

impl Drop for Listener {
    fn drop(&mut self) {
        // What another has put there is not this one's to remove.
        if self.is_found() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// A program that has connected.
#[derive(Debug)]
pub(crate) struct Arrival(Stream);

impl Arrival {
    /// Lets it in: only this user can open the socket.
    ///
    /// # Errors
    /// Never here; the loopback's may fail.
    #[expect(clippy::unnecessary_wraps, reason = "the same as on other systems")]
    pub(crate) fn enter(self) -> io::Result<Stream> {
        Ok(self.0)
    }
}

/// Connects to the program that listens at `path`.
///
/// # Errors
/// No program does.
pub(crate) fn connect(path: &Path) -> io::Result<Stream> {
    UnixStream::connect(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_user_can_connect_and_what_a_killed_program_has_left_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knee.socket");
        std::mem::forget(Listener::at(&path).unwrap());
        let listener = Listener::at(&path).unwrap();
        let mode = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        let _stream = connect(&path).unwrap();
        listener.accept().unwrap().enter().unwrap();
        drop(listener);
        assert!(!path.exists());
        assert!(connect(&path).is_err());
    }

    #[test]
    fn a_path_that_leads_elsewhere_is_noticed_and_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knee.socket");
        let listener = Listener::at(&path).unwrap();
        assert!(listener.is_found());
        let nobody = listener.accept().unwrap_err();
        assert_eq!(nobody.kind(), io::ErrorKind::WouldBlock);
        fs::remove_file(&path).unwrap();
        assert!(!listener.is_found());
        fs::create_dir(&path).unwrap();
        assert!(!listener.is_found());
        let next = Listener::at(&path).unwrap();
        assert!(next.is_found() && !listener.is_found());
        drop(listener);
        assert!(next.is_found());
    }
}

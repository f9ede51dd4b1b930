//! Sockets of Unix: a path in a folder of this user alone.

use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

/// A connection, in blocking mode.
pub(crate) type Stream = UnixStream;

/// Listens at a path, which it removes in the end.
#[derive(Debug)]
pub(crate) struct Listener {
    listener: UnixListener,
    path: PathBuf,
}

impl Listener {
    /// Listens at `path`. What an earlier program has left there is replaced: whoever calls this
    /// has the lock.
    ///
    /// # Errors
    /// Of the system: the folder is gone, or the path too long for a socket.
    pub(crate) fn at(path: &Path) -> io::Result<Self> {
        let _ = fs::remove_file(path);
        let listener = UnixListener::bind(path)?;
        let listener = Self {
            listener,
            path: path.to_owned(),
        };
        // The folder is private already.
        fs::set_permissions(path, Permissions::from_mode(0o600))?;
        Ok(listener)
    }

    /// Ends the wait of [`Self::accept`].
    pub(crate) fn waker(&self) -> impl FnOnce() + Send + 'static {
        let path = self.path.clone();
        move || drop(UnixStream::connect(path))
    }

    /// Waits for a program that connects.
    ///
    /// # Errors
    /// Of the system, as too many open files.
    pub(crate) fn accept(&self) -> io::Result<Arrival> {
        self.listener.accept().map(|(stream, _)| Arrival(stream))
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
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

/// Connects to whoever listens at `path`.
///
/// # Errors
/// Nobody does.
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
}

//! Where the programs that share a device meet: a socket and a lock in the user's
//! folder, named after the device.

use crepitus_client::discovery::{self, DeviceKind};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// Socket and lock of a device.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// The socket on which the hub listens.
    pub(crate) socket: PathBuf,
    /// Whoever has locked this file is the hub, or is about to be. The system
    /// unlocks it when that program ends, however it ends.
    lock: PathBuf,
}

impl Place {
    /// The place of the device at this port.
    pub(crate) fn of(port: &str) -> io::Result<Self> {
        let folder = discovery::make_user_folder()?.join("shared");
        fs::create_dir_all(&folder)?;
        let name = name_of(port);
        Ok(Self {
            socket: folder.join(format!("{name}.socket")),
            lock: folder.join(format!("{name}.lock")),
        })
    }

    /// The lock, unless another program has it.
    pub(crate) fn lock(&self) -> io::Result<Option<File>> {
        let file = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&self.lock)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(file)),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

/// The device's serial number; of a port that is not on USB, its path.
fn name_of(port: &str) -> String {
    let resolved = |port: &str| fs::canonicalize(port).unwrap_or_else(|_| PathBuf::from(port));
    let path = resolved(port);
    let usb = discovery::usb_devices().unwrap_or_default();
    let serial_number = usb.into_iter().find_map(|device| match device.kind {
        DeviceKind::Usb { serial_number } if resolved(&device.port) == path => serial_number,
        _ => None,
    });
    file_name(&serial_number.map_or(path, PathBuf::from))
}

/// A path as the name of a file: letters, digits, dots, and dashes for all else.
fn file_name(path: &Path) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || c == '.' {
            c
        } else {
            '-'
        }
    };
    let name: String = path.to_string_lossy().chars().map(plain).collect();
    name.trim_matches(['-', '.']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_the_same_by_any_path() {
        assert_eq!(file_name(Path::new("/dev/pts/7")), "dev-pts-7");
        assert_eq!(file_name(Path::new("../a b/\u{e9}")), "a-b");
        let folder = tempfile::tempdir().unwrap();
        let port = folder.path().join("port");
        fs::write(&port, "").unwrap();
        let [direct, around] = [port.clone(), folder.path().join("./../").join(&port)]
            .map(|path| name_of(path.to_str().unwrap()));
        assert_eq!(direct, around);
    }
}

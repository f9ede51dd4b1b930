//! Meeting place of the programs that share a device: a socket and a lock in the user's
//! folder, named after the device.

use crate::discovery::{self, DeviceKind};
use crepitus_protocol::frame::CRC;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// Name of the folder in the user's folder.
const FOLDER: &str = "shared";

/// The most bytes that the path of a socket has, without its ending: systems allow 104 to 108.
const LONGEST: usize = 95;

/// Socket and lock of a device.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// Name of the device.
    name: String,
    /// The socket on which the hub listens.
    pub(crate) socket: PathBuf,
    /// Lock file: the program that has locked it is the hub, or is about to be. The system
    /// unlocks it when that program ends, however it ends.
    lock: PathBuf,
}

impl Place {
    /// The place of the device at this port.
    pub(crate) fn of(port: &str) -> io::Result<Self> {
        Self::in_user_folder(&name_of(port))
    }

    /// The place of the same device in the user's folder as it is now, which may be another one.
    pub(crate) fn again(&self) -> io::Result<Self> {
        Self::in_user_folder(&self.name)
    }

    fn in_user_folder(name: &str) -> io::Result<Self> {
        let mut folder = discovery::make_user_folder()
            .map_err(|error| of_user_folder(&error))?
            .join(FOLDER);
        if folder.as_os_str().len() + name.len() > LONGEST {
            folder = discovery::make_temporary_user_folder()?.join(FOLDER);
        }
        fs::create_dir_all(&folder)?;
        Ok(Self::in_folder(&folder, name))
    }

    /// Places of programs that were started with another environment: from a cron job, or as
    /// another user that became this one.
    pub(crate) fn others(port: &str) -> Vec<Self> {
        let name = name_of(port);
        let folders = discovery::user_folders().into_iter();
        folders
            .map(|folder| Self::in_folder(&folder.join(FOLDER), &name))
            .filter(|place| place.socket.exists())
            .collect()
    }

    pub(crate) fn in_folder(folder: &Path, name: &str) -> Self {
        let short = shortened(name, LONGEST.saturating_sub(folder.as_os_str().len()));
        Self {
            name: name.to_owned(),
            socket: folder.join(format!("{short}.socket")),
            lock: folder.join(format!("{short}.lock")),
        }
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

    /// Returns whether this lock is the one that other programs find.
    #[cfg(unix)]
    pub(crate) fn has(&self, lock: &File) -> bool {
        use std::os::unix::fs::MetadataExt;
        let identity = |file: io::Result<fs::Metadata>| file.ok().map(|m| (m.dev(), m.ino()));
        let own = identity(lock.metadata());
        own.is_some() && own == identity(fs::metadata(&self.lock))
    }

    /// The same, where files have no numbers: whether there is one.
    #[cfg(not(unix))]
    pub(crate) fn has(&self, _: &File) -> bool {
        self.lock.exists()
    }
}

/// Adds to an error the folder that it is about.
fn of_user_folder(error: &io::Error) -> io::Error {
    let folder = discovery::user_folder();
    io::Error::new(error.kind(), format!("{}: {error}", folder.display()))
}

/// The device's serial number, and the path of its port.
fn name_of(port: &str) -> String {
    let resolved = |port: &str| fs::canonicalize(port).unwrap_or_else(|_| PathBuf::from(port));
    let path = resolved(port);
    let usb = discovery::usb_devices().unwrap_or_default();
    let serial_number = usb.into_iter().find_map(|device| match device.kind {
        DeviceKind::Usb { serial_number } if resolved(&device.port) == path => serial_number,
        _ => None,
    });
    named(serial_number.as_deref(), &path)
}

/// Serial numbers are not always different, and some devices have none.
fn named(serial_number: Option<&str>, path: &Path) -> String {
    let path = file_name(path);
    match serial_number.map(|number| file_name(Path::new(number))) {
        Some(number) if !number.is_empty() => format!("{number}-{path}"),
        _ => path,
    }
}

/// A name that fits: the end of one that does not is a checksum of all of it. No folder is so deep
/// that this is not enough, or the system refuses the socket.
fn shortened(name: &str, room: usize) -> String {
    if name.len() <= room {
        return name.to_owned();
    }
    let sum = format!("-{:08x}", CRC.checksum(name.as_bytes()));
    let begin = name.get(..room.saturating_sub(sum.len()));
    begin.unwrap_or_default().to_owned() + &sum
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
    fn two_devices_meet_at_two_places() {
        let ports = [Path::new("/dev/ttyACM0"), Path::new("/dev/ttyACM1")];
        for number in [None, Some(""), Some("//"), Some("SIM-COMMS-01")] {
            let [one, other] = ports.map(|port| named(number, port));
            assert_ne!(one, other);
            assert!(!one.starts_with(['.', '-']), "{one}");
        }
        assert_eq!(named(Some("A 1"), ports[0]), "A-1-dev-ttyACM0");
    }

    /// macOS has 104 bytes for a path, and half of them are in that of its temporary folder.
    #[test]
    fn a_long_name_fits_and_stays_its_own() {
        let folder =
            Path::new("/var/folders/zz/zyxvpxvq6csfxvn_n0000000000000/T/crepitus-501/shared");
        let number = "0123456789ABCDEF01234567";
        let [one, other] = ["/dev/cu.usbmodem1101", "/dev/cu.usbmodem1102"]
            .map(|path| Place::in_folder(folder, &named(Some(number), Path::new(path))).socket);
        assert_ne!(one, other);
        for path in [one, other] {
            assert!(path.as_os_str().len() <= 103, "{}", path.display());
            assert_eq!(path.extension(), Some("socket".as_ref()));
        }
        assert_eq!(shortened("knee", 4), "knee");
    }

    #[cfg(unix)]
    #[test]
    fn a_lock_that_was_removed_or_replaced_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::in_folder(folder.path(), "knee");
        let lock = place.lock().unwrap().unwrap();
        assert!(place.has(&lock));
        assert!(place.lock().unwrap().is_none());
        fs::remove_file(&place.lock).unwrap();
        assert!(!place.has(&lock));
        let next = place.lock().unwrap().unwrap();
        assert!(place.has(&next) && !place.has(&lock));
    }

    #[test]
    fn names_are_plain_and_the_same_by_any_path() {
        assert_eq!(file_name(Path::new("/dev/pts/7")), "dev-pts-7");
        assert_eq!(file_name(Path::new("../a b/\u{e9}")), "a-b");
        let folder = tempfile::tempdir().unwrap();
        let port = folder.path().join("port");
        fs::write(&port, "").unwrap();
        let name = |path: &Path| name_of(path.to_str().unwrap());
        let own_name = folder.path().file_name().unwrap();
        let around = folder.path().join("..").join(own_name).join("port");
        assert_eq!(name(&around), name(&port));
        // As the links to a serial port by its number.
        #[cfg(unix)]
        {
            let link = folder.path().join("link");
            std::os::unix::fs::symlink(&port, &link).unwrap();
            assert_eq!(name(&link), name(&port));
        }
    }
}

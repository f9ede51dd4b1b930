//! Files that are read: regular ones up to a stated size.
//!
//! ```text
//! a path ──> its kind ──> open, without waiting ──> the kind of what was opened ──> bytes up to a limit
//! ```
//!
//! The kind is checked before opening, as opening a serial port or a tape has effects, and again on
//! the open file, as the path may have changed in between. No call here waits for a writer of a
//! pipe, and none reads more than its limit, whatever the length of the file is said to be.

use std::fmt;
use std::fs::{self, File, FileType};
use std::io::{self, Read};
use std::path::Path;
use std::str::Utf8Error;

/// Longest text of settings, bytes: a scene, a preset, a lesson. Parsed, a text takes a hundred times
/// its length.
pub const TEXT_BYTES: u64 = 2_000_000;

/// Longest table of points or of a chirp, bytes.
pub const TABLE_BYTES: u64 = 64_000_000;

/// Error of a file that cannot be read. The path is the caller's to name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// The path is no regular file.
    #[error("it is {0}, expected a regular file{advice}", advice = .0.advice())]
    Kind(Kind),
    /// A symbolic link without a target.
    #[error("it is a link to a file that does not exist")]
    DanglingLink,
    /// The file is longer than its limit.
    #[error("it is longer than {}, the most that is read here", Size(*.limit_bytes))]
    TooLong {
        /// Limit, bytes.
        limit_bytes: u64,
    },
    /// A text is not UTF-8.
    #[error("it is not UTF-8 text: {0}")]
    NotText(#[from] Utf8Error),
    /// The system cannot open or read it.
    #[error("{0}")]
    Io(#[from] io::Error),
}

/// Kind of what lies at a path, other than a regular file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A folder.
    Folder,
    /// A pipe with or without a name.
    Pipe,
    /// A socket.
    Socket,
    /// A character or block device.
    Device,
    /// Anything else.
    Other,
}

impl Kind {
    const fn advice(self) -> &'static str {
        match self {
            Self::Folder => ": name a file in it",
            Self::Pipe | Self::Device => ": save what it delivers to a file, and name that",
            Self::Socket | Self::Other => "",
        }
    }

    /// Returns the kind of a path; none of a regular file.
    fn of(kind: FileType) -> Option<Self> {
        if kind.is_file() {
            return None;
        }
        if kind.is_dir() {
            return Some(Self::Folder);
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::FileTypeExt;
            if kind.is_fifo() {
                return Some(Self::Pipe);
            }
            if kind.is_socket() {
                return Some(Self::Socket);
            }
            if kind.is_char_device() || kind.is_block_device() {
                return Some(Self::Device);
            }
        }
        Some(Self::Other)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Folder => "a folder",
            Self::Pipe => "a pipe",
            Self::Socket => "a socket",
            Self::Device => "a device",
            Self::Other => "no file",
        })
    }
}

/// Number of bytes in the largest unit that it has one of.
struct Size(u64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            bytes @ 0..1_000 => write!(f, "{bytes} bytes"),
            bytes @ 1_000..1_000_000 => write!(f, "{} kB", bytes / 1_000),
            bytes => write!(f, "{} MB", bytes / 1_000_000),
        }
    }
}

impl From<InputError> for io::Error {
    fn from(error: InputError) -> Self {
        let kind = match &error {
            InputError::Io(error) => error.kind(),
            InputError::Kind(Kind::Folder) => io::ErrorKind::IsADirectory,
            InputError::Kind(_) => io::ErrorKind::InvalidInput,
            InputError::DanglingLink => io::ErrorKind::NotFound,
            InputError::TooLong { .. } => io::ErrorKind::FileTooLarge,
            InputError::NotText(_) => io::ErrorKind::InvalidData,
        };
        match error {
            InputError::Io(error) => error,
            other => Self::new(kind, other),
        }
    }
}

/// Opens a regular file that is read in pieces. Its length is the caller's to bound.
///
/// # Errors
/// [`InputError::Kind`], [`InputError::DanglingLink`], [`InputError::Io`].
pub fn open(path: &Path) -> Result<File, InputError> {
    let there = fs::metadata(path).map_err(|error| {
        let is_dangling = error.kind() == io::ErrorKind::NotFound
            && fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink());
        if is_dangling {
            InputError::DanglingLink
        } else {
            InputError::Io(error)
        }
    })?;
    check(there.file_type())?;
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        // A pipe or a terminal may have taken the place of the file.
        let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
        options.custom_flags(flags.bits().cast_signed());
    }
    let file = options.open(path)?;
    check(file.metadata()?.file_type())?;
    Ok(file)
}

/// Opens a regular file up to a length, for a reader that takes all of it.
///
/// # Errors
/// Those of [`open`], [`InputError::TooLong`].
pub fn open_up_to(path: &Path, limit_bytes: u64) -> Result<io::Take<File>, InputError> {
    let file = open(path)?;
    if file.metadata()?.len() > limit_bytes {
        return Err(InputError::TooLong { limit_bytes });
    }
    Ok(file.take(limit_bytes))
}

/// Reads a regular file up to a length.
///
/// # Errors
/// Those of [`open`], [`InputError::TooLong`].
pub fn read(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, InputError> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    if length > limit_bytes {
        return Err(InputError::TooLong { limit_bytes });
    }
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    // The file may grow meanwhile, and the length of some systems' own files is 0.
    file.take(limit_bytes.saturating_add(1))
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit_bytes {
        return Err(InputError::TooLong { limit_bytes });
    }
    Ok(bytes)
}

/// Reads a regular file of UTF-8 text up to a length.
///
/// # Errors
/// Those of [`read`], [`InputError::NotText`].
pub fn read_to_string(path: &Path, limit_bytes: u64) -> Result<String, InputError> {
    String::from_utf8(read(path, limit_bytes)?)
        .map_err(|error| InputError::NotText(error.utf8_error()))
}

fn check(kind: FileType) -> Result<(), InputError> {
    Kind::of(kind).map_or(Ok(()), |kind| Err(InputError::Kind(kind)))
}

#[cfg(test)]
mod tests;

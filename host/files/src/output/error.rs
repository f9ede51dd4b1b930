//! Errors of writing.

use super::MARKER;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Most names in a message.
const MOST_NAMES: usize = 10;

/// Error of writing.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// Files or folders in the way.
    #[error("{}: in the way: {}", folder.display(), Listed(names, *has_list))]
    InTheWay {
        /// The folder.
        folder: PathBuf,
        /// Their names, and why they are not replaced.
        names: Vec<InTheWay>,
        /// The folder holds a list of this program's files.
        has_list: bool,
    },
    /// A single file that exists, or cannot be one.
    #[error("{} {}", path.display(), Exists(reason))]
    Exists {
        /// The path.
        path: PathBuf,
        /// Reason why it is not replaced.
        reason: Reason,
    },
    /// A path at which no folder can be.
    #[error("{}: {why}", path.display())]
    NoFolder {
        /// The path.
        path: PathBuf,
        /// Reason.
        why: &'static str,
    },
    /// A read or write error.
    #[error("{}: {doing}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// The action that failed.
        doing: &'static str,
        /// The error.
        source: io::Error,
    },
}

impl OutputError {
    /// Returns whether the same would be written with [`Claim::force`](super::Claim::force).
    #[must_use]
    pub fn yields_to_force(&self) -> bool {
        match self {
            Self::InTheWay { names, .. } => names.iter().all(|name| name.reason.yields_to_force()),
            Self::Exists { reason, .. } => reason.yields_to_force(),
            _ => false,
        }
    }
}

/// Name that is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InTheWay {
    /// The name in its folder.
    pub name: String,
    /// Reason why it is not replaced.
    pub reason: Reason,
}

/// Reason why a name is not replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// This program did not write the file, as far as it can prove.
    Foreign,
    /// The file is not as it was written.
    Changed,
    /// The file is read-only.
    ReadOnly,
    /// A symbolic link.
    Link,
    /// A file of another verb.
    By(String),
    /// The list of files is of another version.
    OtherVersion,
    /// A folder that this program did not make.
    Folder,
    /// A file or a link where a folder belongs.
    NoFolder,
    /// A device, a pipe or a socket.
    Special,
    /// An input.
    Input,
}

impl Reason {
    /// Returns whether [`Claim::force`](super::Claim::force) replaces what is there.
    #[must_use]
    pub const fn yields_to_force(&self) -> bool {
        !matches!(
            self,
            Self::Folder | Self::NoFolder | Self::Special | Self::Input
        )
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Foreign => "not written by crepitus",
            Self::Changed => "changed since crepitus wrote it",
            Self::ReadOnly => "read-only",
            Self::Link => "a symbolic link",
            Self::By(verb) => return write!(f, "written by `{verb}`"),
            Self::OtherVersion => "a list of files of another version of crepitus",
            Self::Folder => "a folder that is not crepitus's",
            Self::NoFolder => "a file or a link where a folder belongs",
            Self::Special => "neither a file nor a folder",
            Self::Input => "an input, which is never replaced",
        })
    }
}

struct Exists<'r>(&'r Reason);

impl fmt::Display for Exists<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Reason::Foreign => f.write_str("already exists"),
            reason => write!(f, "already exists: {reason}"),
        }
    }
}

struct Listed<'n>(&'n [InTheWay], bool);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(names, has_list) = self;
        let is_one = names
            .windows(2)
            .all(|pair| pair[0].reason == pair[1].reason);
        for (number, name) in names.iter().take(MOST_NAMES).enumerate() {
            let comma = if number == 0 { "" } else { ", " };
            write!(f, "{comma}{}", name.name)?;
            if !is_one {
                write!(f, " ({})", name.reason)?;
            }
        }
        if names.len() > MOST_NAMES {
            write!(f, " and {} more", names.len() - MOST_NAMES)?;
        }
        if let Some(first) = names.first().filter(|_| is_one) {
            write!(f, " ({})", first.reason)?;
        }
        let is_foreign = |name: &InTheWay| name.reason == Reason::Foreign;
        if !has_list && names.iter().any(is_foreign) {
            write!(
                f,
                "; this folder has no list of crepitus's files ({MARKER}), as those of earlier versions"
            )?;
        }
        Ok(())
    }
}

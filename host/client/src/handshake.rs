//! Handshake: identities and compatibility.

use crepitus_protocol::management::Identity;
use crepitus_protocol::schema;
use std::cmp::Ordering;
use std::fmt;

/// Major, minor, patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Version(pub [u8; 3]);

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [major, minor, patch] = self.0;
        write!(f, "{major}.{minor}.{patch}")
    }
}

/// The version of this library, and of the tool that is built with it.
pub const TOOL_VERSION: Version = Version([
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
]);

const fn number(text: &str) -> u8 {
    let mut rest = text.as_bytes();
    let mut number = 0;
    while let [digit, tail @ ..] = rest {
        number = number * 10 + (*digit - b'0');
        rest = tail;
    }
    number
}

/// Identities of both controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handshake {
    /// The comms controller.
    pub comms: Identity,
    /// The drive controller, if comms knows its identity.
    pub drive: Option<Identity>,
}

impl Handshake {
    /// Checks the schema hashes. If comms differs, only the management lane
    /// works; if only the drive differs, the device replies but rejects arming.
    pub fn mismatch(&self) -> Option<Mismatch> {
        let drive_differs = self.drive.is_some_and(|drive| drive.schema != schema::HASH);
        (self.comms_differs() || drive_differs).then_some(Mismatch(*self))
    }

    pub(crate) fn comms_differs(&self) -> bool {
        self.comms.schema != schema::HASH
    }
}

/// The schema hashes of host and device differ.
///
/// The error's text gives both versions and the one to replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mismatch(pub Handshake);

impl Mismatch {
    /// Version and schema hash of this side.
    pub fn tool(&self) -> (Version, u64) {
        (TOOL_VERSION, schema::HASH)
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Handshake { comms, drive } = &self.0;
        writeln!(
            f,
            "this tool and the device are incompatible, their schema hashes differ:"
        )?;
        side(f, "tool", TOOL_VERSION, schema::HASH)?;
        side(f, "comms", Version(comms.version), comms.schema)?;
        if let Some(drive) = drive {
            side(f, "drive", Version(drive.version), drive.schema)?;
        }
        let mut is_first = true;
        for (name, identity) in [("comms", Some(comms)), ("drive", drive.as_ref())] {
            let Some(identity) = identity.filter(|identity| identity.schema != schema::HASH) else {
                continue;
            };
            if !is_first {
                writeln!(f)?;
            }
            is_first = false;
            remedy(f, name, Version(identity.version))?;
        }
        write!(f, "\n`crepitus info` and `crepitus stop` still work.")
    }
}

fn side(f: &mut fmt::Formatter<'_>, name: &str, version: Version, hash: u64) -> fmt::Result {
    writeln!(f, "  {name:<5}  version {version}, schema {hash:016x}")
}

fn remedy(f: &mut fmt::Formatter<'_>, name: &str, version: Version) -> fmt::Result {
    match version.cmp(&TOOL_VERSION) {
        Ordering::Less => write!(
            f,
            "The firmware of {name} is older: flash `firmware/{name}` of version {TOOL_VERSION}."
        ),
        Ordering::Greater => write!(
            f,
            "The firmware of {name} is newer: install the tool of version {version}."
        ),
        Ordering::Equal => write!(
            f,
            "Tool and {name} have the same version and were built from different sources: \
             build both from the same ones, and flash `firmware/{name}`."
        ),
    }
}

impl std::error::Error for Mismatch {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_that_of_the_package() {
        assert_eq!(TOOL_VERSION.to_string(), env!("CARGO_PKG_VERSION"));
    }
}

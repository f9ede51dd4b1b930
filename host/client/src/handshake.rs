//! Who is there, and whether both sides speak the same language.

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

/// Who is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handshake {
    /// The comms controller.
    pub comms: Identity,
    /// The drive controller, if comms has heard who it is.
    pub drive: Option<Identity>,
}

impl Handshake {
    /// What does not speak this side's language. If it is comms, only the lane
    /// that never changes works; if it is the drive alone, the device answers
    /// and refuses to arm.
    pub fn mismatch(&self) -> Option<Mismatch> {
        let drive_differs = self.drive.is_some_and(|drive| drive.schema != schema::HASH);
        (self.comms_differs() || drive_differs).then_some(Mismatch(*self))
    }

    pub(crate) fn comms_differs(&self) -> bool {
        self.comms.schema != schema::HASH
    }
}

/// This side and the device speak different languages.
///
/// Its text says which side has what, and which one is to be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mismatch(pub Handshake);

impl Mismatch {
    /// This side's version and language.
    pub fn tool(&self) -> (Version, u64) {
        (TOOL_VERSION, schema::HASH)
    }

    /// The version of a tool that speaks the language of comms.
    pub fn tool_needed(&self) -> Version {
        Version(self.0.comms.version)
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Handshake { comms, drive } = &self.0;
        writeln!(
            f,
            "this tool and the device do not speak the same language:"
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
        write!(
            f,
            "\n`crepitus info` and `crepitus stop` work all the same."
        )
    }
}

fn side(f: &mut fmt::Formatter<'_>, name: &str, version: Version, hash: u64) -> fmt::Result {
    writeln!(f, "  {name:<5}  version {version}, language {hash:016x}")
}

fn remedy(f: &mut fmt::Formatter<'_>, name: &str, version: Version) -> fmt::Result {
    match version.cmp(&TOOL_VERSION) {
        Ordering::Less => write!(
            f,
            "The program of {name} is older: flash `firmware/{name}` of version {TOOL_VERSION}."
        ),
        Ordering::Greater => write!(
            f,
            "The program of {name} is newer: install the tool of version {version}."
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

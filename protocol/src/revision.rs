//! Typed numbers: revision, session and nonce.

use core::fmt;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Revision of the parameters, incremented by every commit. 0 is a drive
/// without parameters that comms knows of.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct Revision(pub u32);

impl Revision {
    /// No parameters received yet since comms has started.
    pub const NONE: Self = Self(0);

    /// The next revision; never [`Self::NONE`].
    pub fn next(self) -> Self {
        Self(self.0.checked_add(1).unwrap_or(1))
    }

    /// Returns whether it comes before another, also where they wrap. [`Self::NONE`] has no place.
    pub fn is_before(self, other: Self) -> bool {
        self.0.wrapping_sub(other.0).cast_signed() < 0
    }
}

impl fmt::Display for Revision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Session of a host: a random number chosen at each connection.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct Session(pub u32);

impl fmt::Display for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}

/// Number that the device draws when a host opens its session. Each request
/// repeats it, so that nothing sent before is executed after a restart.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct Nonce(pub u32);

impl Nonce {
    /// Nonce of a session that is not open; never drawn.
    pub const NONE: Self = Self(0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revision_that_wraps_is_not_none() {
        assert_eq!(Revision(7).next(), Revision(8));
        assert_eq!(Revision(u32::MAX).next(), Revision(1));
        assert!(Revision(u32::MAX).is_before(Revision(1)));
        assert!(!Revision(1).is_before(Revision(u32::MAX)));
        assert!(!Revision(7).is_before(Revision(7)));
    }
}

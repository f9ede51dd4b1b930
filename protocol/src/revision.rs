//! Numbers with a meaning.

use core::fmt;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Which commit of the parameters: each one has the next number. 0 is what a
/// drive has before it was given any.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct Revision(pub u32);

impl Revision {
    /// A drive that was given no parameters yet.
    pub const NONE: Self = Self(0);

    /// The next one; never [`Self::NONE`].
    pub fn next(self) -> Self {
        Self(self.0.checked_add(1).unwrap_or(1))
    }
}

impl fmt::Display for Revision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Which host is speaking: a number that each one chooses at random as it
/// connects.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct Session(pub u32);

impl fmt::Display for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revision_that_wraps_is_not_none() {
        assert_eq!(Revision(7).next(), Revision(8));
        assert_eq!(Revision(u32::MAX).next(), Revision(1));
    }
}

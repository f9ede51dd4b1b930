//! Session of a client: a number for each connection.

use crepitus_protocol::Session;
use std::hash::{BuildHasher, RandomState};
use std::time::SystemTime;

/// Session settings. The default is right except in tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Session number.
    pub session: Session,
    /// Sequence number of the first request.
    pub first_number: u32,
}

impl Default for Options {
    /// A random session: two clients collide with a probability of 2⁻³².
    fn default() -> Self {
        let seed = (std::process::id(), SystemTime::now());
        let [a, b, c, d, ..] = RandomState::new().hash_one(seed).to_le_bytes();
        Self {
            session: Session(u32::from_le_bytes([a, b, c, d])),
            first_number: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sessions_differ() {
        assert_ne!(Options::default().session, Options::default().session);
    }
}

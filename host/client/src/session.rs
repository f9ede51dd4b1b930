//! Who is speaking: a number for each connection.

use crepitus_protocol::Session;
use std::hash::{BuildHasher, RandomState};
use std::time::SystemTime;

/// How a client speaks. The default is right for everything but tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// The number by which the device knows this client.
    pub session: Session,
    /// Number of the first request; they wrap.
    pub first_number: u16,
}

impl Default for Options {
    /// A session at random: two clients have the same one once in four
    /// thousand million times.
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

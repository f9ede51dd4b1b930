//! A character on the wire of the link.

/// A character on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Character {
    /// End of its stop bit, in units of time.
    pub at: u64,
    /// The byte.
    pub byte: u8,
    /// The stop bit is invalid.
    pub is_broken: bool,
}

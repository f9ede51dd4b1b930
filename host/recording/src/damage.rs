//! Handling of damage.

/// Handling of damaged files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Return an error.
    Refuse,
    /// Keep what is readable.
    Salvage,
}

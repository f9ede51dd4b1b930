//! Claim on the names in a folder.

use super::Inputs;

/// Writer of files, and what it may replace.
#[derive(Clone, Debug, Default)]
pub struct Claim {
    /// Verb that writes; it replaces its own earlier files without asking.
    pub by: String,
    /// Replace also foreign files and those of other verbs.
    pub force: bool,
    /// Files that are never replaced.
    pub inputs: Inputs,
}

impl Claim {
    /// Creates the claim of a verb that replaces its own files alone.
    #[must_use]
    pub fn by(verb: &str) -> Self {
        Self {
            by: verb.to_owned(),
            ..Self::default()
        }
    }

    /// Replaces foreign files, too, if `force` is true.
    #[must_use]
    pub fn force(self, force: bool) -> Self {
        Self { force, ..self }
    }

    /// Protects these files.
    #[must_use]
    pub fn reading(self, inputs: Inputs) -> Self {
        Self { inputs, ..self }
    }
}

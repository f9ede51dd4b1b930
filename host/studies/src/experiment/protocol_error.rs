//! Errors of protocols.

use crepitus_scene::values::NamedError;

/// Most trials of a session.
pub const MOST_TRIALS: usize = 2_000;

/// Error of a protocol.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProtocolError {
    /// Text that is not TOML of a protocol; the error's text names the key.
    #[error("the protocol cannot be read: {0}")]
    Form(String),
    /// No kind, or more than one.
    #[error("expected one of [threshold], [abx] and [realism], got {0}")]
    Kinds(usize),
    /// No method, or more than one.
    #[error("[threshold]: expected one of [threshold.constant] and [threshold.staircase], got {0}")]
    Methods(usize),
    /// A text is empty or too long.
    #[error("`{key}` has {characters} characters; expected 1 to {most}")]
    Text {
        /// The key.
        key: &'static str,
        /// Number of characters.
        characters: usize,
        /// The most.
        most: usize,
    },
    /// A number is not allowed.
    #[error("`{key}` is {value}; expected {expected}")]
    Number {
        /// The key.
        key: &'static str,
        /// The value.
        value: f64,
        /// Values that are allowed.
        expected: &'static str,
    },
    /// No trials, or too many.
    #[error("{0} trials; expected 1 to {MOST_TRIALS}: change levels or repeats")]
    Trials(usize),
    /// There is no such preset.
    #[error(
        "there is no preset {preset:?}{}; `crepitus presets` lists them, and \"healthy\" is the knee without one",
        crepitus_scene::similar::question(.similar.as_deref())
    )]
    UnknownPreset {
        /// The name.
        preset: String,
        /// The name that is meant, probably.
        similar: Option<String>,
    },
    /// A preset whose disorder nobody knows cannot be guessed.
    #[error("the preset {0:?} does not say its disorder: add `disorder` to its file")]
    NoDisorder(String),
    /// No parameter of the knee, or a value that it cannot have.
    #[error(transparent)]
    Value(#[from] NamedError),
    /// An entry stands twice in a list.
    #[error("`{key}` has {entry:?} twice")]
    Twice {
        /// The list.
        key: &'static str,
        /// The entry.
        entry: String,
    },
}

/// A number that is not allowed.
pub(super) const fn number(key: &'static str, value: f64, expected: &'static str) -> ProtocolError {
    ProtocolError::Number {
        key,
        value,
        expected,
    }
}

//! Errors of scene files, with cause and remedy.

use std::fmt;
use std::path::PathBuf;

/// Origin of something in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A line of the scene file, counted from 1.
    Line(usize),
    /// An override on the command line, as it was written.
    Override(String),
}

/// A scene that cannot be read: where, which key, what is wrong and what is
/// allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The scene file.
    pub file: PathBuf,
    /// Origin of the error, if it is at one place.
    pub origin: Option<Origin>,
    /// The key with its path, such as `solver.step_s`; empty for the whole
    /// file.
    pub key: String,
    /// Cause of the error, and the valid values.
    pub message: String,
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.origin {
            Some(Origin::Line(line)) => write!(f, "{}, line {line}: ", self.file.display())?,
            Some(Origin::Override(text)) => write!(f, "{}, {text}: ", self.file.display())?,
            None => write!(f, "{}: ", self.file.display())?,
        }
        if !self.key.is_empty() {
            write!(f, "`{}`: ", self.key)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for SceneError {}

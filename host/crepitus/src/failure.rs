//! Failures of verbs: the message and the exit code.

use crate::output::{to_stderr, to_stdout};
use crate::safe_text::{message, visible};
use crepitus_files::output::{OutputError, is_stdout};
use crepitus_identify::files::FileError;
use crepitus_scene::SceneError;
use serde_json::{Map, Value, json};
use std::fmt::Display;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// Reason for the failure of a verb.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad usage or bad input: exit code 2.
    Input(String),
    /// The work failed: exit code 1.
    Work(String),
    /// The work failed, and something of it is kept: exit code 1; what is kept, as JSON.
    Kept(String, Map<String, Value>),
    /// The work was done and its result is negative: no message, exit code 1.
    Negative,
    /// The reader of stdout has closed it, or reads nothing while a stop is requested: no message, exit code 1.
    NoReader,
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::input(error)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Refused(why) => Self::Input(why),
            FileError::Interrupted => Self::interrupted(),
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        let advice = match &error {
            OutputError::Io { path, source, .. }
                if source.kind() == io::ErrorKind::BrokenPipe && is_stdout(path) =>
            {
                return Self::NoReader;
            }
            OutputError::Io {
                path,
                doing,
                source,
            } => return Self::at(path, doing, source),
            OutputError::NoFolder { .. } => "name another folder with --out",
            _ if error.yields_to_force() => "choose another place or name, or replace with --force",
            _ => "choose another place or name, or move it away; --force does not replace it",
        };
        Self::Input(format!("{error}: {advice}"))
    }
}

impl Failure {
    /// Bad usage or bad input.
    pub(crate) fn input(error: impl Display) -> Self {
        Self::Input(error.to_string())
    }

    /// Ctrl-C, before anything was written.
    pub(crate) fn interrupted() -> Self {
        Self::Work("interrupted: nothing was written".to_owned())
    }

    /// The work failed at `path`; one that cannot be a file or a folder is bad input.
    pub(crate) fn at(path: &Path, doing: &str, error: &io::Error) -> Self {
        let text = error.to_string();
        // Of a temporary file, whose name is not the user's.
        let text = text.split(" at path \"").next().unwrap_or(&text);
        let message = format!("{}: {doing}: {text}", path.display());
        match error.kind() {
            io::ErrorKind::PermissionDenied
            | io::ErrorKind::ReadOnlyFilesystem
            | io::ErrorKind::NotFound
            | io::ErrorKind::AlreadyExists
            | io::ErrorKind::IsADirectory
            | io::ErrorKind::NotADirectory
            | io::ErrorKind::InvalidFilename => Self::Input(message),
            _ => Self::Work(message),
        }
    }

    /// The message.
    pub(crate) fn into_text(self) -> String {
        match self {
            Self::Input(text) | Self::Work(text) | Self::Kept(text, _) => text,
            Self::Negative | Self::NoReader => String::new(),
        }
    }

    /// Prints the message and returns the exit code.
    pub(crate) fn report(&self, json: bool) -> ExitCode {
        let (text, code) = match self {
            Self::Input(text) => (message(text), 2),
            Self::Work(text) | Self::Kept(text, _) => (message(text), 1),
            Self::Negative | Self::NoReader => return ExitCode::from(1),
        };
        let printed = json && {
            let mut report = json!({ "error": { "message": text, "exit_code": code } });
            if let (Self::Kept(_, kept), Some(report)) = (self, report.as_object_mut()) {
                report.extend(kept.clone());
            }
            // A reader that has closed stdout wants no more; a full disk must not hide the error.
            matches!(print_json(&report), Ok(()) | Err(Self::NoReader))
        };
        if !printed {
            // Without anybody who reads, the exit code tells.
            to_stderr(&format!("error: {text}"));
        }
        ExitCode::from(code)
    }
}

/// Prints a warning to stderr.
pub(crate) fn warn(warning: impl Display) {
    to_stderr(&format!("warning: {}", message(&warning.to_string())));
}

/// Writes text to stdout; a closed reader is a failure, not a panic.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write(&visible(text))
}

fn write(text: &str) -> Result<(), Failure> {
    to_stdout(text).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::NoReader,
        _ => Failure::Work(format!("stdout cannot be written: {error}")),
    })
}

/// Writes JSON and a newline to stdout.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::Work(format!("the result cannot be written as JSON: {e}")))?;
    // JSON escapes control characters in strings.
    write(&(text + "\n"))
}

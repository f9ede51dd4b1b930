//! How a verb fails: the text a person reads and the exit code a script reads.

use crate::safe_text::{message, visible};
use serde_json::json;
use std::fmt::Display;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// Why a verb did not do what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad usage or bad input: exit code 2.
    Input(String),
    /// The work failed: exit code 1.
    Work(String),
    /// The work was done and its result says no: nothing more to say, exit
    /// code 1.
    Negative,
    /// Whoever read the output has gone: nothing more to say, exit code 1.
    NoReader,
}

impl Failure {
    /// Bad usage or bad input.
    pub(crate) fn input(error: impl Display) -> Self {
        Self::Input(error.to_string())
    }

    /// The work failed at `path`; a place where this user may not work is bad
    /// input.
    pub(crate) fn at(path: &Path, doing: &str, error: &io::Error) -> Self {
        let told = format!("{}: {doing}: {error}", path.display());
        match error.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                Self::Input(told)
            }
            _ => Self::Work(told),
        }
    }

    /// Says what was wrong and gives the exit code.
    pub(crate) fn report(&self, json: bool) -> ExitCode {
        let (told, code) = match self {
            Self::Input(told) => (message(told), 2),
            Self::Work(told) => (message(told), 1),
            Self::Negative | Self::NoReader => return ExitCode::from(1),
        };
        if json {
            // Where stdout is gone, the exit code is all that is left.
            let _ = print_json(&json!({ "error": { "message": told, "exit_code": code } }));
        } else {
            eprintln!("error: {told}");
        }
        ExitCode::from(code)
    }
}

/// Says on stderr what was odd.
pub(crate) fn warn(warning: impl Display) {
    eprintln!("warning: {}", message(&warning.to_string()));
}

/// Writes text to stdout; a reader that has gone is a failure, not a panic.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write(&visible(text))
}

fn write(text: &str) -> Result<(), Failure> {
    use io::Write;
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(|_| Failure::NoReader)
}

/// Writes JSON and a line's end to stdout.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::Work(format!("cannot be written as JSON: {e}")))?;
    // Its strings are escaped as JSON wants it.
    write(&(text + "\n"))
}

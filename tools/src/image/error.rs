//! Errors that prevent the check of an image.

use std::path::PathBuf;

/// Reason why an image or its budget cannot be read. Not a finding about the image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file is not an ELF file that can be parsed.
    #[error("not a readable ELF file: {0}")]
    Elf(#[from] object::Error),
    /// The file is an ELF file, but for another machine.
    #[error("not a 32-bit little-endian ARM executable")]
    Machine,
    /// There are no mapping symbols, without which code and data cannot be distinguished.
    #[error(
        "no mapping symbols ($t, $d): code and data cannot be told apart; do not strip the image"
    )]
    Stripped,
    /// There is no vector table.
    #[error("no section .vector_table")]
    NoVectors,
    /// `memory.x` cannot be parsed.
    #[error("memory layout, line {line}: {what}")]
    Memory {
        /// Line, from 1.
        line: usize,
        /// Description of what was found or is missing.
        what: String,
    },
    /// The budget file is invalid.
    #[error("{}: {what}", path.display())]
    Budget {
        /// The budget file.
        path: PathBuf,
        /// The error, with its position.
        what: String,
    },
    /// The image does not have this symbol.
    #[error("no function {name} in the image{}", hint(near.as_deref()))]
    NoFunction {
        /// The name as given.
        name: String,
        /// A similar name.
        near: Option<String>,
    },
}

fn hint(near: Option<&str>) -> String {
    near.map_or_else(String::new, |name| format!("; did you mean {name}?"))
}

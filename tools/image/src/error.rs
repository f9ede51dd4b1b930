//! What keeps an image from being examined at all.

use std::path::PathBuf;

/// Why an image or its budget cannot be read. Not a finding about the image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not an ELF file that can be parsed.
    #[error("not a readable ELF file: {0}")]
    Elf(#[from] object::Error),
    /// The file is an ELF file, but for another machine.
    #[error("not a 32-bit little-endian ARM executable")]
    Machine,
    /// Without mapping symbols code and data cannot be told apart.
    #[error(
        "no mapping symbols ($t, $d): code and data cannot be told apart; do not strip the image"
    )]
    Stripped,
    /// Nothing says where the interrupts begin.
    #[error("no section .vector_table")]
    NoVectors,
    /// `memory.x` says something that is not understood.
    #[error("memory layout, line {line}: {what}")]
    Memory {
        /// Line, from 1.
        line: usize,
        /// What was found or is missing.
        what: String,
    },
    /// The budget file is not what it should be.
    #[error("{}: {what}", path.display())]
    Budget {
        /// The budget file.
        path: PathBuf,
        /// What is wrong, with its position.
        what: String,
    },
    /// A symbol was asked for that the image does not have.
    #[error("no function {name} in the image{}", hint(near.as_deref()))]
    NoFunction {
        /// The name as given.
        name: String,
        /// A name that resembles it.
        near: Option<String>,
    },
}

fn hint(near: Option<&str>) -> String {
    near.map_or_else(String::new, |name| format!("; did you mean {name}?"))
}

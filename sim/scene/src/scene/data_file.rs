//! A file that a scene reads beside its own.

use crepitus_files::input;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A file of data, identified by its content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DataFile {
    /// Whole path of the file.
    pub file: PathBuf,
    /// SHA-256 of its content, in hex digits.
    pub sha256: String,
    /// Assumptions about its form, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub read_as: Vec<String>,
}

impl DataFile {
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        let mut sha256 = String::new();
        let mut sha = Sha256::new();
        let mut piece = vec![0; 1 << 16];
        let mut file = input::open(path)?;
        loop {
            match file.read(&mut piece)? {
                0 => break,
                read => sha.update(&piece[..read]),
            }
        }
        for byte in sha.finalize() {
            let _ = write!(sha256, "{byte:02x}");
        }
        Ok(Self {
            file: path.canonicalize()?,
            sha256,
            read_as: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_the_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        std::fs::write(&path, "abc").unwrap();
        let data = DataFile::of(&path).unwrap();
        // FIPS 180-4, example 1.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(data.sha256, expected);
        assert!(data.file.is_absolute());
        assert!(DataFile::of(&folder.path().join("none")).is_err());
    }
}

//! # Files
//!
//! The one place that opens files of other people and writes files beside theirs:
//!
//! ```text
//! a path ──> input   a regular file up to a stated size, or an error that says what it is
//! bytes  ──> table   names, units and rows, in whatever form a laboratory writes them
//! a path <── output  a folder that this program owns: nothing foreign is replaced or removed
//! a name ──> names   whether every system has a file of it
//! ```
#![forbid(unsafe_code)]

pub mod characters;
pub mod input;
pub mod names;
pub mod output;
pub mod table;

use std::path::Path;

/// A path as JSON can have it: what is not UTF-8 in it becomes U+FFFD, as JSON has no bytes.
pub fn json_path(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

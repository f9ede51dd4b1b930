//! # Recordings
//!
//! Every sample of a device in one file: which device made the samples, its
//! parameters from which tick on, and the books of what is missing.
//!
//! ```text
//!           while recording              when it has ended
//! blocks ──> Recorder ──> log in FILE ──> Parquet in FILE     (feature `parquet`)
//!                              │               │
//!                              └───────┬───────┘
//!                                  Recording ──> rows ──> Analysis ──> object, events, summary
//!                                      └──> CSV, MCAP
//! ```
//!
//! Whenever the program is killed, the log can be read up to its last whole
//! frame ([`Recorder`]); the Parquet file takes its place at once or not at all.
//! [`Recording::open`] reads either, checks every byte of it, counts rows and
//! gaps and compares them with the books. `docs/recorded.md` is the book on the
//! formats.
#![forbid(unsafe_code)]

mod analysis;
mod arming;
mod books;
mod ending;
mod findings;
mod log;
#[cfg(feature = "mcap")]
mod mcap;
mod metadata;
mod parameters;
#[cfg(feature = "parquet")]
mod parquet;
mod recording;
mod report_columns;
mod row;
mod samples;
mod shaft;

pub use analysis::{Analysis, Derived, Object, RecordingSummary};
pub use arming::ArmingPushes;
pub use books::{Begin, Books, Cause, Gap, Segment, Totals};
pub use ending::{EndCause, Ending};
pub use findings::Findings;
pub use log::disk::{Background, Disk};
pub use log::recorder::{RecordError, Recorder};
pub use metadata::{Controller, Metadata};
pub use parameters::{History, InForce, Named, ParameterSet, named_values};
pub use recording::{Damage, Format, ReadError, Recording, Rows, seconds};
pub use report_columns::ReportColumns;
pub use row::{COLUMNS, Row, Step};
pub use samples::Samples;

use std::fs::File;
use std::io;
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a recording to an empty file, durably; tells the number of rows so
/// far, and ends with [`Interrupted`](std::io::ErrorKind::Interrupted) if that
/// returns false. Returns the number of rows of the new file.
pub type Write =
    fn(&Recording, &std::fs::File, &mut dyn FnMut(u64) -> bool) -> std::io::Result<u64>;

/// The writer of Parquet files; none if this was built without the feature
/// `parquet`.
pub fn parquet_writer() -> Option<Write> {
    #[cfg(feature = "parquet")]
    return Some(parquet::write);
    #[cfg(not(feature = "parquet"))]
    None
}

/// The writer of MCAP files; none if this was built without the feature `mcap`.
pub fn mcap_writer() -> Option<Write> {
    #[cfg(feature = "mcap")]
    return Some(mcap::write);
    #[cfg(not(feature = "mcap"))]
    None
}

/// A file that is to appear whole, with this name in the end.
///
/// # Errors
/// Of the disk.
pub fn new_file(path: &Path) -> io::Result<NamedTempFile> {
    let folder = folder_of(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".crepitus-");
    // The usual permissions, not those of a temporary file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Puts the name of a file on the disk; where folders cannot be opened the system does it.
///
/// # Errors
/// Of the disk.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    match File::open(folder_of(path)) {
        Ok(folder) if cfg!(unix) => folder.sync_all(),
        _ => Ok(()),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Lower-case hex digits.
fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

//! # Recordings
//!
//! Every sample of a device in one file: which device made the samples, its
//! parameters from which tick on, and the accounting of what is missing.
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
//! gaps and compares them with the accounting. `docs/recorded.md` is the book on the
//! formats.
#![forbid(unsafe_code)]

mod accounting;
mod arming;
mod column;
mod damage;
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
mod row;
mod samples;
mod shaft;

pub use accounting::{Cause, Gap, Recount, SampleAccounting, Segment, Totals};
pub use arming::ArmingPushes;
pub use column::{COLUMNS, Cell, Column};
pub use crepitus_protocol::accounting::Begin;
pub use damage::Damage;
pub use ending::{EndCause, Ending};
pub use findings::Findings;
pub use log::disk::{Background, Disk};
pub use log::recorder::{RecordError, Recorder};
pub use metadata::{Controller, Metadata};
pub use parameters::{History, InForce, Named, ParameterSet, named_values};
pub use recording::{Format, ReadError, Recording, Rows};
pub use row::{Row, Step, seconds};
pub use samples::Samples;

use std::path::Path;

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

/// Returns whether a file is the recording with this id, as far as it can be read; a link is none.
pub fn is_recording(file: &Path, id: &str) -> bool {
    let is_file = std::fs::symlink_metadata(file).is_ok_and(|entry| entry.is_file());
    let is_own = |recording: Recording| recording.metadata().id == id;
    is_file && Recording::open(file, Damage::Salvage).is_ok_and(is_own)
}

//! # Recordings
//!
//! Every sample of a device in a CSV file, with a JSON file beside it: which
//! device made the samples, its parameters from which tick on, and the gaps.
//!
//! ```text
//! blocks ──> Recorder ──> name.csv   one line per sample, appended as they arrive
//!                    └──> name.json  replaced atomically at each change
//!
//! name.csv, name.json ──> Recording ──> rows ──> Analysis ──> object, events, summary
//! ```
//!
//! Whenever the program is killed, the files can be read: the CSV file up to its
//! last complete line, and the last JSON file. Gaps since then follow from the
//! ticks of the lines.
#![forbid(unsafe_code)]

mod analysis;
mod arming;
mod recorder;
mod recording;
mod row;
mod samples;
mod shaft;
mod sidecar;

pub use analysis::{Analysis, Derived, Object, RecordingSummary, seconds};
pub use arming::ArmingPushes;
pub use recorder::{RecordError, Recorder};
pub use recording::{ReadError, Recording, Rows};
pub use row::{COLUMNS, Row, RowError};
pub use samples::Samples;
pub use sidecar::{Controller, Gap, ParameterSet, Sidecar, Totals, named_values};

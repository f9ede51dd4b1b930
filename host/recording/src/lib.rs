//! # Recordings
//!
//! Every sample of a device in a CSV file, with a JSON file beside it that
//! says what it is: who made the samples, with which parameters from which
//! tick on, and what is missing.
//!
//! ```text
//! blocks ──> Recorder ──> name.csv   a line a sample, appended as they come
//!                    └──> name.json  whole at every moment: written anew at each change
//!
//! name.csv, name.json ──> Recording ──> rows
//! ```
//!
//! Whenever the program is killed, what is on the disk can be read: the CSV
//! file up to its last whole line, and the JSON file as it was. What the JSON
//! file then does not say yet, the ticks of the lines do.
#![forbid(unsafe_code)]

mod arming;
mod recorder;
mod recording;
mod row;
mod samples;
mod shaft;
mod sidecar;

pub use arming::ArmingPushes;
pub use recorder::{RecordError, Recorder};
pub use recording::{ReadError, Recording, Rows};
pub use row::{COLUMNS, Row, RowError};
pub use samples::Samples;
pub use sidecar::{Controller, Gap, ParameterSet, Sidecar, Totals, named_values};

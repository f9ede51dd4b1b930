//! A device's recording as a report shows it: what its samples come to, and its columns.

pub mod analysis;
mod columns;

pub use analysis::{Analysis, Derived, Object, RecordingSummary};
pub use columns::ReportColumns;

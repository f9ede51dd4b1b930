//! Examinations and swings from files: recordings of a device, and tables in whatever form a laboratory writes
//! them.
//!
//! | to find | look in |
//! |---|---|
//! | columns by what they are called, and their units | `columns.rs` |
//! | times and angles of a table | `angle_table.rs` |
//! | angle and torque of a passive examination | `examination.rs` |
//! | a weight that swings in the brace | `swings.rs`, `swung_table.rs` |

mod angle_table;
mod columns;
mod examination;
mod swings;
mod swung_table;

pub use angle_table::AngleColumns;
pub use examination::{ExaminationColumns, TorqueUnit, read_examination};
pub use swings::{read_swings, recording};
pub use swung_table::{NM_PER_A, SwingColumns};

/// Error of reading a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// Something is missing or wrong.
    #[error("{0}")]
    Refused(String),
    /// The caller has ended it.
    #[error("interrupted")]
    Interrupted,
}

/// Returns a refusal with a reason.
#[expect(
    clippy::needless_pass_by_value,
    reason = "used where errors are mapped"
)]
fn refused(why: impl ToString) -> FileError {
    FileError::Refused(why.to_string())
}

/// Rejects a number that is not above zero.
fn above_zero(option: &str, value: f64) -> Result<(), FileError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(refused(format!(
        "{option}: expected a number above 0, got {value}"
    )))
}

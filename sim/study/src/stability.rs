//! Which hard cases hold: a catalogue of them, run on every rung × convention
//! × precision, each with a verdict and the margin that was measured.
//!
//! ```text
//! catalogue: case = inputs + criteria ─┐
//!                                      ├─> run ─> observation ─> verdict ─┬─> cases.csv
//! subject = rung × convention × f32/64 ┘                                  └─> matrix, report
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the cases | [`catalogue`] |
//! | who is put to the test | [`subject`] |
//! | what came of it | [`verdict`], [`matrix`] |

pub mod case;
pub mod catalogue;
pub mod matrix;
pub mod subject;
pub mod verdict;

pub use case::Case;
pub use matrix::{Cell, Matrix, Row};
pub use subject::Subject;
pub use verdict::{Failure, Margin, Verdict};

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
//! | the cases | [`catalogue`], and what they are made of: [`case`], [`input`], [`criterion`] |
//! | who is put to the test | [`subject`] |
//! | how a case is run and judged | `source`, `observe`, `books`, `judge` |
//! | what came of it | [`verdict`], [`matrix`] |
//! | an input as data, for a joint elsewhere | [`replay`] |
//! | the file of it | [`cases_csv`] |
//! | runs that explain a case | [`story`] |

mod books;
pub mod case;
pub mod cases_csv;
pub mod catalogue;
mod changed;
pub mod criterion;
pub mod input;
mod judge;
mod locators;
pub mod matrix;
mod observation;
mod observe;
mod random;
mod rendered;
pub mod replay;
mod shaken;
mod sighted;
mod source;
pub mod story;
pub mod subject;
mod text;
pub mod verdict;
mod without_steps;

pub use case::{Case, Trial};
pub use criterion::Criterion;
pub use input::Input;
pub use matrix::{Cell, Matrix, Plan, Row, run};
pub use subject::{Rung, Subject};
pub use verdict::{Failure, Margin, Verdict};

//! The hard cases: a catalogue, run on every rung × convention × precision,
//! with a verdict and the measured margin for each.
//!
//! ```text
//! catalogue: case = inputs + criteria ─┐
//!                                      ├─> run ─> observation ─> verdict ─┬─> cases.csv
//! subject = rung × convention × f32/64 ┘                                  └─> matrix, report
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the cases | [`catalogue`], and their parts: [`case`], [`input`], [`criterion`] |
//! | the tested solvers | [`subject`] |
//! | how a case is run and judged | `source`, `observe`, `symptom`, `actuator`, `energy_audit`, `judge` |
//! | results | [`verdict`], [`matrix`] |
//! | an input as data, for a joint elsewhere | [`replay`] |
//! | the file of results | [`cases_table`] |
//! | runs that explain a case | [`story`] |
//! | what is printed, and the page's text | [`StabilityOutcome`] |

mod actuator;
pub mod case;
pub mod cases_table;
pub mod catalogue;
pub mod criterion;
mod energy_audit;
mod guarded_joint;
pub mod input;
mod judge;
mod locators;
pub mod matrix;
mod observation;
mod observe;
mod parameter_changes;
mod rendered;
pub mod replay;
pub mod report;
mod scene_run;
mod shaking_hand;
mod source;
pub mod story;
pub mod subject;
mod symptom;
pub(crate) mod text;
pub mod verdict;
mod without_steps;
mod words;

pub use case::{Case, Trial};
pub use criterion::Criterion;
pub use input::Input;
pub use matrix::{Cell, Matrix, Plan, Row, run};
pub use subject::{Rung, Subject};
pub use verdict::{Failure, Margin, Verdict};
pub use words::{StabilityOutcome, markdown, value};

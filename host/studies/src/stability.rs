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
//! | the cases | [`catalogue`], and their parts: [`Case`], [`Input`], [`Criterion`] |
//! | the tested solvers | [`subject`] |
//! | how a case is run and judged | `source`, `observe`, `device_run`, `symptom`, `actuator`, `energy_audit`, `criteria` |
//! | results | [`verdict`], [`matrix`] |
//! | an input as data, for a joint elsewhere | [`replay`] |
//! | the file of results | `cases_table` |
//! | runs that explain a case | [`story`] |
//! | what is printed, and the page's text | [`StabilityOutcome`] |

mod actuator;
mod case;
mod cases_table;
pub mod catalogue;
mod criteria;
pub mod criterion;
mod device_run;
mod energy_audit;
mod guarded_joint;
pub(crate) mod input;
pub mod matrix;
mod observation;
mod observe;
mod parameter_changes;
pub mod replay;
pub mod report;
mod scene_run;
mod source;
pub mod story;
pub mod subject;
mod symptom;
pub(crate) mod text;
pub mod verdict;
mod view;
mod without_steps;
mod words;

pub use case::{Case, Trial};
pub use criterion::Criterion;
pub use input::Input;
pub use matrix::{Cell, Matrix, Plan, Row, run};
pub use subject::{Rung, Subject};
pub use verdict::{Failure, Margin, Verdict};
pub use words::{StabilityOutcome, markdown, value};

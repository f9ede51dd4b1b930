//! # Sweeps
//!
//! Many runs of one scene: which, on all cores, a row each.
//!
//! ```text
//! scene ─┐                   ┌─ shard ─┐
//!        ├─> Plan ── points ─┼─ shard ─┼─> rows ──> Parts ──> table
//! axes ──┴ Design            └─ shard ─┘  run_all   (files)   (Parquet, CSV)
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | `PATH=a:b:linN` | [`axis`] |
//! | grid, Latin hypercube, Sobol's sequence, points of another program | [`design`] |
//! | what a sweep is, and its parts | [`plan`] |
//! | which numbers a row has | [`row`] |
//! | the threads | [`pool`] |
//! | points that are run together | `together` |
//! | what lets a sweep go on after a kill, and on several computers | [`parts`] |
//! | the folder of a sweep | [`store`] |
//! | what repeats a sweep | [`recipe`] |
//! | the file in the end | [`table`] |
//!
//! A point is a function of its number, and a row one of its point: so rows are the same
//! on any number of cores and computers, in one go or in ten.

mod again;
pub mod axis;
pub mod design;
pub mod kind;
pub mod parts;
pub mod plan;
pub mod pool;
pub mod recipe;
pub mod row;
mod running;
pub mod store;
mod store_error;
pub mod table;
mod together;
mod traced;

pub use again::Again;
pub use axis::Axis;
pub use design::{Design, DesignError, Points, Sampled};
pub use parts::{Parts, missing};
pub use plan::{Identity, Plan, Shard};
pub use pool::{Ended, Receiver, Stop, Threads, run_all};
pub use recipe::Recipe;
pub use row::{Cell, Row};
pub use store::{Opening, Store};
pub use store_error::StoreError;
pub use table::{Content, Format, Table, TableError, Written};
pub use together::totals;
pub use traced::{Traces, traced};

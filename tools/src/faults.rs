//! Planted faults: does a test detect what is wrong?
//!
//! ```text
//! tools/faults/<area>/<name>.patch ─> scratch copy of the sources, one fault at a time
//!   ─> the test that the patch names, which must fail ─> `Result` in the patch
//!   ─> docs/generated/planted-faults.md, which is made of the patches alone
//! ```
//!
//! The sources in the work tree are never changed. A test fails if a patch does not apply to them
//! as they are, or has no result, and if the page is not that of the patches.
//!
//! [`mutants`] are not chosen by us: all that `cargo mutants` lists of a crate.

pub mod image_edit;
pub mod mutants;
pub mod outcome;
pub mod page;
pub mod patch;
pub mod process;
pub mod tree;
pub mod trial;

//! Planted faults: does a check detect a wrong model?
//!
//! ```text
//! faults.toml ─> scratch copy of the sources, each fault behind a switch, built once
//!                  ├─> the hard cases, one fault in force ─┐
//!                  └─> the model's tests, likewise        ─┴─> docs/generated/planted-faults.md
//! ```
//!
//! A fault replaces an expression in an exact text that occurs once in its
//! file. The work tree is never changed: the faults are planted in a copy.
//! There each is one branch of an `if`, so that one build serves them all
//! (mutant schemata: Untch, Offutt and Harrold 1993).

//!
//! Faults of the drive's firmware are built one by one instead:
//!
//! ```text
//! firmware.toml ─> scratch copy of the sources ─> an image a fault ─> the emulator's tests
//!                                                   └─> docs/generated/planted-firmware-faults.md
//! ```

//! [`mutants`] are not chosen by us: all that `cargo mutants` lists of a crate.

pub mod fault;
pub mod firmware;
pub mod firmware_page;
pub mod firmware_trial;
pub mod mutants;
pub mod outcome;
pub mod page;
pub mod process;
pub mod tree;
pub mod trial;

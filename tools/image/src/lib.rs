//! # Firmware images, examined
//!
//! The gate that a firmware image passes before it is taken: its sizes, where
//! it is loaded, how deep its stack gets, and what its interrupts can reach.
//! All from the finished ELF file, without running it and without a
//! disassembler from outside.
//!
//! ```text
//! ELF ── elf ──> sections, symbols ── sweep, decode ──> instructions
//!                                           │ body (constants resolve calls)
//!  vector table ── vectors ──> roots        v
//!                                └──────> program ──> loops, stack, reach
//! budget.toml ── budget ──┐                 │
//! memory.x ───── memory ──┴──> gate <───────┘ ──> report ──> text, JSON
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the form of the budget file | [`budget`] |
//! | the checks themselves | [`gate`] |
//! | which instructions are understood, and how | [`decode`] |
//! | what counts as a loop, and which never end | [`loops`] |
//! | how the worst stack adds up | [`stack`] |
//! | which functions mean a panic | [`panics`] |
//!
//! **What it cannot see.** It reads control flow, not values: whether a bound
//! that the budget states for a loop holds is for the reader of the budget
//! file to judge, and so are the targets given for calls through pointers.
//! Faults by address, waiting for hardware inside a bounded loop, the time
//! that anything takes, vector tables that are moved at run time and code
//! that is copied or made at run time are beyond it. The stack of thread mode
//! is a lower bound where it calls through pointers; the report says so.
//! Handlers of faults add to it only where the budget lists them. Loops are
//! those of the machine code: where the compiler has made one of two nested
//! loops without anything between them, one bound covers both. Where it has
//! dissolved a loop, its bound stays for one that comes later in that function.

pub mod body;
pub mod budget;
pub mod components;
pub mod constants;
pub mod decode;
pub mod elf;
pub mod error;
pub mod gate;
pub mod lines;
pub mod look;
pub mod loops;
pub mod memory;
pub mod panics;
pub mod program;
pub mod reach;
pub mod report;
pub mod stack;
pub mod sweep;
pub mod text;
pub mod vectors;

pub use budget::Budget;
pub use elf::Image;
pub use error::ImageError;
pub use gate::{Subject, examine};
pub use report::Report;

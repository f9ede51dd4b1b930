//! # Checks of firmware images
//!
//! The gate of a firmware image: its sizes, load addresses, worst stack, and
//! the code reachable from its interrupts.
//! All from the finished ELF file, without running it and without an external
//! disassembler.
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
//! | decoded instructions | [`decode`] |
//! | loops, and endless loops | [`loops`] |
//! | the sum of the worst stack | [`stack`] |
//! | functions that mean a panic | [`panics`] |
//!
//! **Limits.** It analyses control flow, not values: whether a loop keeps the
//! bound of the budget is for the reader of the budget file to judge, and so
//! are the targets given for calls through pointers.
//! Faults by address, waiting for hardware inside a bounded loop, execution
//! time, vector tables that are moved at run time and code
//! that is copied or made at run time are not checked. The stack of thread mode
//! is a lower bound if it calls through pointers; the report says so.
//! Fault handlers add to it only if the budget lists them. Loops are
//! those of the machine code: if the compiler has merged two nested
//! loops without anything between them, one bound covers both. If it has
//! removed a loop, its bound applies to a later one in that function.

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
pub use gate::{Subject, examine, needless_loops};
pub use report::Report;

//! Timing of tiny programs.

mod assembler;
mod core;

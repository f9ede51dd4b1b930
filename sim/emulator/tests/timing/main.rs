//! Timing of tiny programs, and what a core keeps over an exception.

mod assembler;
mod core;
mod exceptions;

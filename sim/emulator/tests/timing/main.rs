//! Timing of tiny programs, and of the flash interface alone.

mod assembler;
mod core;
mod exceptions;
mod fast_path;
mod flash;
mod flash_writes;
mod reference;
mod reference_flash;
mod registers;

//! scene (being written)
pub mod trace;

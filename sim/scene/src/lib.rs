//! scene (being written)
pub mod reference;
pub mod trace;

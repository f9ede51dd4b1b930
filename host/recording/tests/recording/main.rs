//! Recordings as files: written, cut off, damaged, read back.

mod damage;
mod disk;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "parquet")]
mod parquet;
mod support;
mod whole;

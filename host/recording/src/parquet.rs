//! A recording as one Parquet file.
//!
//! ```text
//! PAR1 ‖ group ‖ seal ‖ group ‖ seal … ‖ footer ‖ PAR1
//! ```
//!
//! A *group* holds two seconds of rows, column by column. Its *seal*
//! ([`seal`]) has the group's checksum and a footer for this group alone, so
//! that the rest can be read if any part of the file is lost, and the
//! recording's id, so that a group of another one is known. Other readers
//! follow the offsets in the footer and skip the seals.
//!
//! The footer's key-value metadata has the recording's own (`crepitus`: JSON)
//! and `crepitus_sha256`, the SHA-256 of the whole file with that value's 64
//! digits replaced by zeros: every bit of the file is covered.

mod columns;
mod reader;
mod seal;
mod words;
mod writer;

use crate::accounting::SampleAccounting;
use crate::ending::Ending;
use crate::metadata::Metadata;
use crate::parameters::History;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
pub(crate) use reader::{ParquetRows, Reader};
use serde::{Deserialize, Serialize};
use std::io;
pub(crate) use writer::write;

/// Rows of a group: two seconds.
const GROUP_ROWS: usize = 40_000;

/// Keys of the footer's metadata.
const KEY: &str = "crepitus";
const SUM_KEY: &str = "crepitus_sha256";

/// Key of a seal's footer that has a group: the recording's id.
const ID_KEY: &str = "crepitus_id";

/// Stands for the file's own checksum while that is computed.
const NO_SUM: [u8; 64] = [b'0'; 64];

/// All of a recording but its rows.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct About {
    #[serde(flatten)]
    pub(crate) metadata: Metadata,
    pub(crate) is_complete: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ending: Option<Ending>,
    pub(crate) parameters: History,
    #[serde(rename = "books")]
    pub(crate) accounting: SampleAccounting,
    /// Damage of the file that it was made of, in sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) damage: Vec<String>,
}

/// Position of the checksum in the bytes of a footer.
fn sum_place(footer: &[u8]) -> Option<usize> {
    let key = SUM_KEY.as_bytes();
    let at = footer
        .windows(key.len())
        .rposition(|window| window == key)?;
    // Behind the key: the next field's type, and its length.
    let value = at + key.len() + 2;
    (value + NO_SUM.len() <= footer.len()).then_some(value)
}

/// A value in a footer's metadata.
fn value<'f>(footer: &'f ParquetMetaData, key: &str) -> Option<&'f str> {
    let pairs = footer.file_metadata().key_value_metadata()?;
    let pair = pairs.iter().find(|pair| pair.key == key)?;
    pair.value.as_deref()
}

/// An error of the library.
fn other(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(source) => io::Error::other(source),
        },
        error => io::Error::other(error),
    }
}

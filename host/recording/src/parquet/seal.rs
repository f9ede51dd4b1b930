//! Seals of groups.
//!
//! ```text
//! seal = mark (16 bytes) ‖ length u32 ‖ CRC-32 u32 ‖ body       numbers little endian
//! body = group's first byte u64 ‖ its length u64 ‖ its CRC-32 u32 ‖ first row u64 ‖ footer
//! ```
//!
//! The seal before the first group covers no bytes, and its footer has no group:
//! it holds the recording's metadata, in case that in the footer is lost.

use super::{ID_KEY, other, value};
use crepitus_protocol::frame::CRC;
use parquet::file::metadata::{
    FileMetaData, ParquetMetaData, ParquetMetaDataReader, ParquetMetaDataWriter, RowGroupMetaData,
};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// Unlikely in data.
const MARK: &[u8; 16] = b"\xe7crepitus group\x1c";

/// Bytes of the length and the checksum.
const HEAD: usize = 8;

/// Bytes of the body before the footer.
const FIXED: usize = 28;

/// A seal.
#[derive(Clone, Debug)]
pub(super) struct Seal {
    /// Byte at which it stands, which is where its group ends.
    pub(super) at: u64,
    pub(super) first_byte: u64,
    pub(super) bytes: u64,
    pub(super) crc: u32,
    pub(super) first_row: u64,
    /// Number of rows of the group.
    pub(super) rows: u64,
    /// The recording's; none in the seal before the first group.
    pub(super) id: Option<String>,
    /// Footer with this group alone, encoded: decoded it takes ten times the memory.
    footer: Vec<u8>,
}

/// Writes a seal.
pub(super) fn seal(
    bytes: (u64, &[u8]),
    first_row: u64,
    file: FileMetaData,
    groups: Vec<RowGroupMetaData>,
) -> io::Result<Vec<u8>> {
    let (first_byte, group) = bytes;
    let mut body = first_byte.to_le_bytes().to_vec();
    body.extend((group.len() as u64).to_le_bytes());
    body.extend(CRC.checksum(group).to_le_bytes());
    body.extend(first_row.to_le_bytes());
    let footer = ParquetMetaData::new(file, groups);
    ParquetMetaDataWriter::new(&mut body, &footer)
        .finish()
        .map_err(other)?;
    let length = u32::try_from(body.len()).map_err(io::Error::other)?;
    let mut seal = MARK.to_vec();
    seal.extend(length.to_le_bytes());
    seal.extend(CRC.checksum(&body).to_le_bytes());
    seal.extend(body);
    Ok(seal)
}

impl Seal {
    /// The footer, decoded.
    pub(super) fn footer(&self) -> io::Result<ParquetMetaData> {
        ParquetMetaDataReader::decode_metadata(&self.footer).map_err(other)
    }

    /// Reads the body of a seal at this byte; none if it is damaged.
    fn of(at: u64, body: &[u8]) -> Option<Self> {
        let (first_byte, rest) = body.split_first_chunk()?;
        let (bytes, rest) = rest.split_first_chunk()?;
        let (crc, rest) = rest.split_first_chunk()?;
        let (first_row, footer) = rest.split_first_chunk()?;
        debug_assert_eq!(body.len() - footer.len(), FIXED);
        // Behind it stand its length and `PAR1`.
        let thrift = footer.get(..footer.len().checked_sub(8)?)?;
        let footer = ParquetMetaDataReader::decode_metadata(thrift).ok()?;
        let rows: i64 = footer
            .row_groups()
            .iter()
            .map(RowGroupMetaData::num_rows)
            .sum();
        Some(Self {
            at,
            first_byte: u64::from_le_bytes(*first_byte),
            bytes: u64::from_le_bytes(*bytes),
            crc: u32::from_le_bytes(*crc),
            first_row: u64::from_le_bytes(*first_row),
            rows: u64::try_from(rows).ok()?,
            id: value(&footer, ID_KEY).map(str::to_owned),
            footer: thrift.to_vec(),
        })
    }
}

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 20;

/// Finds every seal of a file that is in order.
pub(super) fn find(mut file: &File) -> io::Result<Vec<Seal>> {
    let mut seals = Vec::new();
    let mut window: Vec<u8> = Vec::new();
    // Where the window begins.
    let mut begin = 0;
    file.seek(SeekFrom::Start(0))?;
    loop {
        let before = window.len();
        file.take(BLOCK as u64).read_to_end(&mut window)?;
        let is_end = window.len() == before;
        let mut at = 0;
        while let Some(found) = position(&window[at..]) {
            at += found;
            match length(&window[at..]) {
                Some(length) if at + length <= window.len() => {
                    seals.extend(checked(begin + at as u64, &window[at..at + length]));
                    at += MARK.len();
                }
                // The rest of it is yet to be read.
                Some(_) if !is_end => break,
                None if !is_end && window.len() - at < MARK.len() + HEAD => break,
                _ => at += MARK.len(),
            }
        }
        if is_end {
            return Ok(seals);
        }
        // A mark may begin in the last bytes.
        let keep = if position(&window[at..]).is_some() {
            at
        } else {
            at.max((window.len() + 1).saturating_sub(MARK.len()))
        };
        let keep = keep.min(window.len());
        begin += keep as u64;
        window.drain(..keep);
    }
}

/// Offset of the next mark.
fn position(bytes: &[u8]) -> Option<usize> {
    bytes.windows(MARK.len()).position(|window| window == MARK)
}

/// Longest seal: a large history of parameters.
const LONGEST: usize = 1 << 26;

/// Length of a seal with its mark and head; none if that is not there or too
/// long.
fn length(bytes: &[u8]) -> Option<usize> {
    let head = bytes.get(MARK.len()..)?.first_chunk()?;
    let length = usize::try_from(u32::from_le_bytes(*head)).ok()?;
    (length <= LONGEST).then_some(MARK.len() + HEAD + length)
}

fn checked(at: u64, seal: &[u8]) -> Option<Seal> {
    let (head, body) = seal.get(MARK.len()..)?.split_first_chunk::<HEAD>()?;
    let crc = u32::from_le_bytes(*head.last_chunk()?);
    (CRC.checksum(body) == crc).then(|| Seal::of(at, body))?
}

#[cfg(test)]
mod tests {
    use super::super::columns;
    use super::*;
    use parquet::file::metadata::KeyValue;
    use parquet::schema::types::SchemaDescriptor;
    use std::io::Write;
    use std::sync::Arc;

    /// Also if it is read in two parts: behind each byte of mark and head.
    #[test]
    fn a_seal_is_found_wherever_it_stands() {
        let schema = SchemaDescriptor::new(Arc::new(columns::schema().unwrap()));
        let id = KeyValue::new(ID_KEY.to_owned(), "an id".to_owned());
        let footer = FileMetaData::new(2, 0, None, Some(vec![id]), Arc::new(schema), None);
        let bytes = seal((0, &[]), 0, footer, Vec::new()).unwrap();
        for at in BLOCK - MARK.len() - HEAD..=BLOCK {
            let mut file = tempfile::tempfile().unwrap();
            file.seek(SeekFrom::Start(at as u64)).unwrap();
            file.write_all(&bytes).unwrap();
            let seals = find(&file).unwrap();
            let found: Vec<_> = seals.iter().map(|s| (s.at, s.id.as_deref())).collect();
            assert_eq!(found, [(at as u64, Some("an id"))], "at {at}");
        }
    }
}

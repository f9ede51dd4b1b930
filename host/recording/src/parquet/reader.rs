//! Reading: only what its checksums say is right is handed to the decoder.

use super::seal::{self, Seal};
use super::{About, KEY, NO_SUM, columns, other, value};
use crate::accounting::{Recount, RowCount, SampleAccounting};
use crate::findings::Findings;
use crate::metadata::Metadata;
use crate::row::Row;
use bytes::{Buf, Bytes, buf};
use crepitus_files::input;
use crepitus_protocol::frame::CRC;
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::{ChunkReader, Length};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// A Parquet file that was checked.
#[derive(Debug)]
pub(crate) struct Reader {
    file: File,
    /// Seals of the groups that are in order.
    seals: Vec<Seal>,
}

/// Bytes of the file's end: the footer's length and `PAR1`.
const TAIL: usize = 8;

impl Reader {
    /// Reads all of it once.
    pub(crate) fn open(path: &Path) -> io::Result<(Self, About, Findings)> {
        let file = input::open(path)?;
        let mut findings = Findings::default();
        let footer = footer(&file)?;
        let is_whole = sum_is_right(&file, footer.as_ref())?;
        let seals = seal::find(&file)?;
        let mut about = None;
        if let (true, Some((_, bytes))) = (is_whole, &footer) {
            about = about_of(&decoded(bytes)?);
        }
        if !is_whole {
            findings.add("Its checksum is not that of its content".to_owned());
        }
        if about.is_none() {
            let footer = footer.as_ref().map(|(_, bytes)| bytes.as_slice());
            about = salvaged_about(&seals, footer, &mut findings);
        }
        let is_lost = about.is_none();
        let mut about = match about {
            Some(about) => about,
            None => lost_about(&seals, &mut findings).ok_or_else(unreadable)?,
        };
        let mut reader = Self {
            file,
            seals: Vec::new(),
        };
        reader.keep(seals, &mut about, &mut findings)?;
        if is_lost {
            about.accounting = reader.counted()?;
        }
        Ok((reader, about, findings))
    }

    /// Keeps the groups that are in order, and counts their rows.
    fn keep(
        &mut self,
        seals: Vec<Seal>,
        about: &mut About,
        findings: &mut Findings,
    ) -> io::Result<()> {
        let accounting = about.accounting.clone();
        let mut recount = Recount::new(&accounting);
        let mut kept = Vec::new();
        let mut next_row = 0;
        for seal in own_groups(seals, &about.metadata.id, findings) {
            if seal.first_row < next_row {
                findings.add(format!("Rows from {} on are there twice", seal.first_row));
                continue;
            }
            let Some(rows) = self.group(&seal)? else {
                continue;
            };
            if seal.first_row > next_row {
                let of = match accounting.totals.received {
                    // The accounting of the file is lost.
                    0 => String::new(),
                    all => format!(" of {all}"),
                };
                findings.add(format!(
                    "Rows {next_row} to {}{of} are damaged",
                    seal.first_row - 1
                ));
            }
            for row in &rows {
                recount.row(row.tick);
            }
            next_row = seal.first_row + rows.len() as u64;
            kept.push((seal.first_row, rows.len() as u64));
            self.seals.push(seal);
        }
        if next_row < accounting.totals.received {
            findings.add(format!(
                "Rows {next_row} to {} are missing at its end",
                accounting.totals.received - 1
            ));
        }
        if findings.is_empty() {
            for difference in recount.differences() {
                findings.add(format!("It has {difference}"));
            }
            return Ok(());
        }
        forget_lost_rows(about, &kept);
        let accounting = about.accounting.clone();
        let mut recount = Recount::new(&accounting);
        let mut rows = self.rows();
        while let Some(row) = rows.next()? {
            recount.row(row.tick);
        }
        about.accounting = recount.into_accounting();
        Ok(())
    }

    /// Accounting of its rows, which have none.
    fn counted(&self) -> io::Result<SampleAccounting> {
        let mut count = RowCount::default();
        let mut next_row = 0;
        for seal in &self.seals {
            let mut lost = seal.first_row.saturating_sub(next_row);
            let rows = self.kept_group(seal)?;
            for row in &rows {
                count.row(row, std::mem::take(&mut lost));
            }
            next_row = seal.first_row + rows.len() as u64;
        }
        Ok(count.into_accounting())
    }

    /// The rows of a group that was read before.
    fn kept_group(&self, seal: &Seal) -> io::Result<Vec<Row>> {
        let changed = || io::Error::other("the file changes while it is read");
        self.group(seal)?.ok_or_else(changed)
    }

    /// The rows of a group; none if it is damaged.
    fn group(&self, seal: &Seal) -> io::Result<Option<Vec<Row>>> {
        // Where bytes were lost or added before it, it stands elsewhere, before its seal.
        let moved = seal.at.checked_sub(seal.bytes);
        let places = std::iter::once(seal.first_byte).chain(moved);
        let mut found = None;
        for place in places {
            if found.is_none() {
                found = self.bytes(place, seal)?;
            }
        }
        let Some(bytes) = found else {
            return Ok(None);
        };
        let group = GroupBytes {
            first_byte: seal.first_byte,
            bytes: bytes.into(),
        };
        columns::read(&Arc::new(group), seal.footer()?.row_group(0)).map(Some)
    }

    /// The bytes of a group, if it stands at this place.
    fn bytes(&self, place: u64, seal: &Seal) -> io::Result<Option<Vec<u8>>> {
        let length = usize::try_from(seal.bytes).map_err(io::Error::other)?;
        let mut bytes = Vec::new();
        let mut file = &self.file;
        file.seek(SeekFrom::Start(place))?;
        file.take(seal.bytes).read_to_end(&mut bytes)?;
        let is_it = bytes.len() == length && CRC.checksum(&bytes) == seal.crc;
        Ok(is_it.then_some(bytes))
    }

    pub(crate) fn rows(&self) -> ParquetRows<'_> {
        ParquetRows {
            reader: self,
            due: self.seals.iter(),
            group: Vec::new().into_iter(),
        }
    }
}

fn unreadable() -> io::Error {
    io::Error::new(
        io::ErrorKind::InvalidData,
        "neither its footer nor the seal of any group can be read: nothing is left of it, or \
         `crepitus record` has not written it",
    )
}

/// Metadata of a file whose checksum is wrong: from the seal before the first group, or from
/// the footer, which has no checksum of its own. None if both are lost.
fn salvaged_about(seals: &[Seal], footer: Option<&[u8]>, findings: &mut Findings) -> Option<About> {
    // Where its end is lost, other bytes stand in its place.
    let footer = footer.filter(|footer| footer.ends_with(b"PAR1"));
    let mut heads = seals.iter().filter(|seal| seal.rows == 0);
    let head = heads.find_map(|seal| about_of(&seal.footer().ok()?));
    let own_id = match &head {
        Some(head) => Some(head.metadata.id.as_str()),
        None => id_of_most(seals),
    };
    let footer_id = footer.and_then(id_in);
    let is_foreign = own_id.is_some() && footer_id.is_some() && own_id != footer_id;
    if is_foreign {
        findings
            .add("Its footer is that of another recording, or the id in it is damaged".to_owned());
    }
    if head.is_some() || is_foreign {
        return head;
    }
    let about = about_of(&decoded(footer?).ok()?)?;
    findings.add("Its metadata could not be checked".to_owned());
    Some(about)
}

/// Metadata of a file of which only groups are left; none if there is no group either.
fn lost_about(seals: &[Seal], findings: &mut Findings) -> Option<About> {
    if seals.iter().all(|seal| seal.rows == 0) {
        return None;
    }
    findings.add("Its metadata is lost: its device and its parameters are unknown".to_owned());
    Some(About {
        metadata: Metadata {
            id: id_of_most(seals).unwrap_or_default().to_owned(),
            title: "A recording whose metadata is lost".to_owned(),
            ..Metadata::unknown()
        },
        ..About::default()
    })
}

/// The id that most groups have; of several, that of the first.
fn id_of_most(seals: &[Seal]) -> Option<&str> {
    let mut counts: Vec<(&str, u64)> = Vec::new();
    for id in seals.iter().filter_map(|seal| seal.id.as_deref()) {
        match counts.iter_mut().find(|(known, _)| *known == id) {
            Some((_, count)) => *count += 1,
            None => counts.push((id, 1)),
        }
    }
    // Of equals, `max_by_key` takes the last.
    let most = counts.iter().rev().max_by_key(|(_, count)| *count)?;
    Some(most.0)
}

/// The recording's id in the bytes of a footer, read without the decoder: the footer may be
/// damaged.
fn id_in(footer: &[u8]) -> Option<&str> {
    const MARK: &[u8] = b"\"id\":\"";
    let at = footer.windows(MARK.len()).position(|part| part == MARK)?;
    let id = footer.get(at + MARK.len()..)?;
    let id = id.split(|byte| *byte == b'"').next()?;
    std::str::from_utf8(id).ok()
}

/// The groups of the recording with this id, in the order of their rows.
fn own_groups(seals: Vec<Seal>, id: &str, findings: &mut Findings) -> Vec<Seal> {
    let mut groups: Vec<Seal> = Vec::new();
    for seal in seals.into_iter().filter(|seal| seal.rows > 0) {
        if seal.id.as_deref().is_some_and(|other| other != id) {
            let at = seal.first_byte;
            findings.add(format!(
                "Rows of another recording stand in it, at byte {at}, and are left out"
            ));
        } else {
            groups.push(seal);
        }
    }
    let rows = groups.iter().map(|seal| seal.first_row);
    let mut pairs = rows.clone().zip(rows.skip(1));
    if let Some((_, row)) = pairs.find(|(before, row)| row < before) {
        findings.add(format!("Rows are out of order, first those from {row} on"));
    }
    groups.sort_by_key(|seal| seal.first_row);
    groups
}

/// Offset of the footer, and its bytes.
fn footer(mut file: &File) -> io::Result<Option<(u64, Vec<u8>)>> {
    let length = file.metadata()?.len();
    let Some(tail_at) = length.checked_sub(TAIL as u64) else {
        return Ok(None);
    };
    let mut tail = [0; TAIL];
    file.seek(SeekFrom::Start(tail_at))?;
    file.read_exact(&mut tail)?;
    let [a, b, c, d, ..] = tail;
    let footer_bytes = u64::from(u32::from_le_bytes([a, b, c, d]));
    let Some(at) = tail_at.checked_sub(footer_bytes) else {
        return Ok(None);
    };
    let mut footer = Vec::new();
    file.seek(SeekFrom::Start(at))?;
    file.read_to_end(&mut footer)?;
    Ok(Some((at, footer)))
}

fn decoded(footer: &[u8]) -> io::Result<ParquetMetaData> {
    let thrift = footer.len().saturating_sub(TAIL);
    ParquetMetaDataReader::decode_metadata(&footer[..thrift]).map_err(other)
}

fn about_of(footer: &ParquetMetaData) -> Option<About> {
    serde_json::from_str(value(footer, KEY)?).ok()
}

/// True if the file is the one that was written, to the last bit.
fn sum_is_right(mut file: &File, footer: Option<&(u64, Vec<u8>)>) -> io::Result<bool> {
    let Some((footer_byte, footer)) = footer else {
        return Ok(false);
    };
    let Some(at) = super::sum_place(footer) else {
        return Ok(false);
    };
    let mut zeroed = footer.clone();
    let Some(place) = zeroed.get_mut(at..at + NO_SUM.len()) else {
        return Ok(false);
    };
    let said = place.to_vec();
    place.copy_from_slice(&NO_SUM);
    let mut sum = Sha256::new();
    file.seek(SeekFrom::Start(0))?;
    let mut before = file.take(*footer_byte);
    let mut buffer = vec![0; 1 << 16];
    loop {
        match before.read(&mut buffer)? {
            0 => break,
            count => sum.update(&buffer[..count]),
        }
    }
    sum.update(&zeroed);
    Ok(crepitus_files::output::hex(&sum.finalize()).as_bytes() == said)
}

/// Renumbers rows where some are lost.
fn forget_lost_rows(about: &mut About, kept: &[(u64, u64)]) {
    let kept_before = |row: u64| {
        kept.iter()
            .map(|(first, rows)| row.saturating_sub(*first).min(*rows))
            .sum::<u64>()
    };
    for segment in &mut about.accounting.segments {
        segment.first_row = kept_before(segment.first_row);
    }
    for set in &mut about.parameters.0 {
        set.first_row = kept_before(set.first_row);
    }
}

/// A group in memory, at its place in the file.
struct GroupBytes {
    first_byte: u64,
    bytes: Bytes,
}

impl GroupBytes {
    fn from(&self, start: u64) -> ParquetResult<Bytes> {
        let at = start
            .checked_sub(self.first_byte)
            .and_then(|at| usize::try_from(at).ok())
            .filter(|at| *at <= self.bytes.len());
        let at =
            at.ok_or_else(|| parquet::errors::ParquetError::EOF("outside its group".to_owned()))?;
        Ok(self.bytes.slice(at..))
    }
}

impl Length for GroupBytes {
    fn len(&self) -> u64 {
        self.first_byte + self.bytes.len() as u64
    }
}

impl ChunkReader for GroupBytes {
    type T = buf::Reader<Bytes>;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        Ok(self.from(start)?.reader())
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        let bytes = self.from(start)?;
        if length > bytes.len() {
            return Err(parquet::errors::ParquetError::EOF(
                "outside its group".to_owned(),
            ));
        }
        Ok(bytes.slice(..length))
    }
}

/// Rows, a group at a time.
#[derive(Debug)]
pub(crate) struct ParquetRows<'r> {
    reader: &'r Reader,
    due: std::slice::Iter<'r, Seal>,
    group: std::vec::IntoIter<Row>,
}

impl ParquetRows<'_> {
    pub(crate) fn next(&mut self) -> io::Result<Option<Row>> {
        loop {
            if let Some(row) = self.group.next() {
                return Ok(Some(row));
            }
            let Some(seal) = self.due.next() else {
                return Ok(None);
            };
            self.group = self.reader.kept_group(seal)?.into_iter();
        }
    }
}

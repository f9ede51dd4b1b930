//! Bytes of a part file.
//!
//! ```text
//! crepitus-part,1,<sweep>,<shard>,<first point>,<end>,<number of columns>
//! name,kind,value of the first row,value of the second row,…      one record a column
//! name,kind,the one value of all rows
//! sha256,<of all bytes before this line>
//! ```
//!
//! CSV with a record a *column*: most columns of a sweep do not vary, and a table is written column by
//! column.

use super::{Cells, Column};
use crate::sweep::kind::Kind;
use crate::sweep::plan::Shard;
use crepitus_files::output::sha256;
use std::io;
use std::ops::Range;

/// Largest part that is read: 8192 rows take less than a hundredth.
pub(super) const MOST_BYTES: u64 = 1 << 30;

const MAGIC: &str = "crepitus-part";
const VERSION: &str = "1";
const SUM: &str = "sha256,";
/// Length of the last line: name, hex digits, its end.
const SUM_BYTES: usize = SUM.len() + 64 + 1;

/// First record of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// [`Identity::id`](crate::sweep::plan::Identity::id).
    pub(super) sweep: String,
    pub(super) shard: Shard,
    pub(super) points: Range<u64>,
}

/// Returns the bytes of a part.
pub(super) fn write(header: &Header, columns: &[Column]) -> io::Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new()
        .flexible(true)
        .from_writer(Vec::new());
    let Header {
        sweep,
        shard,
        points,
    } = header;
    writer.write_record([
        MAGIC,
        VERSION,
        sweep,
        &shard.to_string(),
        &points.start.to_string(),
        &points.end.to_string(),
        &columns.len().to_string(),
    ])?;
    for column in columns {
        writer.write_field(&column.name)?;
        writer.write_field(column.kind.name())?;
        match &column.cells {
            Cells::Constant(text) => writer.write_field(text)?,
            Cells::Each(texts) => {
                for text in texts {
                    writer.write_field(text)?;
                }
            }
        }
        writer.write_record(None::<&[u8]>)?;
    }
    let mut bytes = writer
        .into_inner()
        .map_err(|error| io::Error::other(error.to_string()))?;
    let sum = sum_line(&bytes)?;
    bytes.extend(sum.as_bytes());
    Ok(bytes)
}

fn sum_line(body: &[u8]) -> io::Result<String> {
    Ok(format!("{SUM}{}\n", sha256(body)?))
}

/// Reads the bytes of a part with these points.
///
/// # Errors
/// Reason why it is none.
pub(super) fn read(bytes: &[u8], points: &Range<u64>) -> Result<(Header, Vec<Column>), String> {
    let begin = format!("{MAGIC},{VERSION},");
    if !bytes.starts_with(MAGIC.as_bytes()) {
        return Err("this is not a part of a sweep, or one of an earlier version".to_owned());
    }
    if !bytes.starts_with(begin.as_bytes()) {
        return Err("this is damaged, or a part of another version".to_owned());
    }
    let (body, sum) = bytes.split_at(bytes.len().saturating_sub(SUM_BYTES));
    let expected = sum_line(body).map_err(|e| e.to_string())?;
    if sum != expected.as_bytes() {
        return Err(
            "this is damaged or was changed: its SHA-256 is not that of its content".to_owned(),
        );
    }
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .has_headers(false)
        .from_reader(body);
    let mut records = reader.records();
    let first = match records.next() {
        Some(Ok(first)) => first,
        Some(Err(e)) => return Err(e.to_string()),
        None => return Err("it is empty".to_owned()),
    };
    let number = |place| {
        first
            .get(place)
            .and_then(|text: &str| text.parse::<u64>().ok())
    };
    let (Some(sweep), Some(Ok(shard)), Some(start), Some(end), Some(count)) = (
        first.get(2),
        first.get(3).map(str::parse::<Shard>),
        number(4),
        number(5),
        number(6),
    ) else {
        return Err("its first line is not that of a part".to_owned());
    };
    let header = Header {
        sweep: sweep.to_owned(),
        shard,
        points: start..end,
    };
    if header.points != *points {
        return Err(format!(
            "it holds the points {start} to {}, and its name says others: it was renamed",
            end.saturating_sub(1)
        ));
    }
    let rows = usize::try_from(end - start).map_err(|_| "too long".to_owned())?;
    let columns = records
        .map(|record| column(&record.map_err(|e| e.to_string())?, rows))
        .collect::<Result<Vec<_>, _>>()?;
    if columns.len() as u64 != count {
        return Err(format!("it has {} columns, not {count}", columns.len()));
    }
    Ok((header, columns))
}

fn column(record: &csv::StringRecord, rows: usize) -> Result<Column, String> {
    let (Some(name), Some(kind)) = (record.get(0), record.get(1).and_then(Kind::of)) else {
        return Err("a record without a name and a kind".to_owned());
    };
    let mut texts: Vec<_> = record.iter().skip(2).map(str::to_owned).collect();
    let cells = match (texts.len(), rows) {
        (count, rows) if count == rows => Cells::Each(texts),
        (1, _) => Cells::Constant(texts.swap_remove(0)),
        (count, _) => return Err(format!("{name} has {count} cells for {rows} rows")),
    };
    Ok(Column {
        name: name.to_owned(),
        kind,
        cells,
    })
}

//! Writing.

use super::seal::seal;
use super::{About, GROUP_ROWS, ID_KEY, KEY, NO_SUM, SUM_KEY, columns, other};
use crate::recording::{ReadError, Recording};
use crate::row::Row;
use parquet::file::metadata::{FileMetaData, KeyValue};
use parquet::file::writer::SerializedFileWriter;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::sync::Arc;

/// The file, with what was written since the last seal.
struct Output<'f> {
    file: BufWriter<&'f File>,
    sum: Sha256,
    length: u64,
    group: Vec<u8>,
}

impl Write for Output<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        let written = &bytes[..count];
        self.sum.update(written);
        self.group.extend(written);
        self.length += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Writes a recording to an empty file, durably. `progress` gets the number of
/// rows so far; if it returns false, writing ends with [`ErrorKind::Interrupted`].
///
/// # Errors
/// Of either file.
pub(crate) fn write(
    recording: &Recording,
    file: &File,
    progress: &mut dyn FnMut(u64) -> bool,
) -> io::Result<u64> {
    let about = About {
        metadata: recording.metadata().clone(),
        is_complete: recording.is_ended(),
        ending: recording.ending().cloned(),
        parameters: recording.parameters().clone(),
        accounting: recording.accounting().clone(),
        damage: recording.inherited_damage(),
    };
    let id = about.metadata.id.clone();
    let mut writer = Writer::new(file, id, serde_json::to_string(&about)?)?;
    let mut rows = Vec::with_capacity(GROUP_ROWS);
    for row in recording.rows().map_err(io_error)? {
        rows.push(row.map_err(io_error)?);
        if rows.len() == GROUP_ROWS {
            writer.group(&mut rows)?;
            if !progress(writer.rows) {
                return Err(ErrorKind::Interrupted.into());
            }
        }
    }
    if !rows.is_empty() {
        writer.group(&mut rows)?;
    }
    let rows = writer.rows;
    writer.finish(file)?;
    Ok(rows)
}

fn io_error(error: ReadError) -> io::Error {
    match error {
        ReadError::Io { source, .. } => source,
        error => io::Error::other(error),
    }
}

struct Writer<'f> {
    file: SerializedFileWriter<Output<'f>>,
    about: KeyValue,
    id: KeyValue,
    rows: u64,
}

impl<'f> Writer<'f> {
    fn new(file: &'f File, id: String, about: String) -> io::Result<Self> {
        let output = Output {
            file: BufWriter::new(file),
            sum: Sha256::new(),
            length: 0,
            group: Vec::new(),
        };
        let schema = Arc::new(columns::schema().map_err(other)?);
        let properties = Arc::new(columns::properties().map_err(other)?);
        let mut writer = Self {
            file: SerializedFileWriter::new(output, schema, properties).map_err(other)?,
            about: KeyValue::new(KEY.to_owned(), about),
            id: KeyValue::new(ID_KEY.to_owned(), id),
            rows: 0,
        };
        writer.begin_group()?;
        writer.seal(0, writer.about.clone())?;
        Ok(writer)
    }

    /// Begins a group with what is written next.
    fn begin_group(&mut self) -> io::Result<()> {
        self.file.flush()?;
        self.file.inner_mut().group.clear();
        Ok(())
    }

    fn group(&mut self, rows: &mut Vec<Row>) -> io::Result<()> {
        let mut group = self.file.next_row_group().map_err(other)?;
        columns::write(rows, &mut group).map_err(other)?;
        group.close().map_err(other)?;
        self.file.flush()?;
        self.seal(self.rows, self.id.clone())?;
        self.rows += rows.len() as u64;
        rows.clear();
        Ok(())
    }

    /// Seals what was written since the last seal.
    fn seal(&mut self, first_row: u64, pair: KeyValue) -> io::Result<()> {
        let groups: Vec<_> = self
            .file
            .flushed_row_groups()
            .last()
            .cloned()
            .into_iter()
            .collect();
        let rows = groups
            .iter()
            .map(parquet::file::metadata::RowGroupMetaData::num_rows)
            .sum();
        let properties = self.file.properties();
        let file = FileMetaData::new(
            properties.writer_version().as_num(),
            rows,
            Some(properties.created_by().to_owned()),
            Some(vec![pair]),
            self.file.schema_descr().clone().into(),
            None,
        );
        let output = self.file.inner();
        let first_byte = output.length - output.group.len() as u64;
        let seal = seal((first_byte, &output.group), first_row, file, groups)?;
        self.file.write_all(&seal)?;
        self.begin_group()
    }

    /// Writes the footer, and then the checksum into it.
    fn finish(mut self, file: &File) -> io::Result<()> {
        let sum = String::from_utf8_lossy(&NO_SUM).into_owned();
        for pair in [self.about, KeyValue::new(SUM_KEY.to_owned(), sum)] {
            self.file.append_key_value_metadata(pair);
        }
        let mut output = self.file.into_inner().map_err(other)?;
        output.flush()?;
        let footer_byte = output.length - output.group.len() as u64;
        let at = super::sum_place(&output.group)
            .ok_or_else(|| io::Error::other("the footer has no checksum"))?;
        let sum = crepitus_files::output::hex(&output.sum.finalize());
        let mut file = file;
        file.seek(SeekFrom::Start(footer_byte + at as u64))?;
        file.write_all(sum.as_bytes())?;
        file.sync_all()
    }
}

//! Columns of the file, as the table of columns has them.

use super::{GROUP_ROWS, other, words};
use crate::column::{COLUMNS, Cell, Column};
use crate::row::{END_TICK, Row, seconds};
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::column::reader::{get_column_reader, get_typed_column_reader};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::{
    ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::Result;
use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
use parquet::file::reader::ChunkReader;
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::file::writer::{SerializedColumnWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::{ColumnPath, Type};
use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

/// Level of zstd: higher ones are slower and hardly smaller.
const ZSTD: i32 = 3;

/// Columns whose values grow by about the same from row to row.
const GROWING: [&str; 2] = ["tick", "count"];

/// The type of a column.
fn type_of(column: &Column) -> String {
    let name = column.name;
    match column.cell {
        Cell::U64(..) => format!("required int64 {name} (INTEGER(64, false))"),
        Cell::U32(..) => format!("required int32 {name} (INTEGER(32, false))"),
        Cell::I32(..) => format!("required int32 {name}"),
        Cell::F64(..) => format!("required double {name}"),
        Cell::F32(..) => format!("required float {name}"),
        Cell::Measured(..) => format!("optional float {name}"),
        Cell::Word(..) => format!("required binary {name} (UTF8)"),
    }
}

/// The encoding of a column, where it is not the usual one.
fn encoding_of(column: &Column) -> Option<Encoding> {
    match column.cell {
        Cell::F64(..) | Cell::F32(..) | Cell::Measured(..) => Some(Encoding::BYTE_STREAM_SPLIT),
        _ if GROWING.contains(&column.name) => Some(Encoding::DELTA_BINARY_PACKED),
        _ => None,
    }
}

pub(super) fn schema() -> Result<Type> {
    let fields: Vec<_> = COLUMNS.iter().map(type_of).collect();
    parse_message_type(&format!("message crepitus {{ {}; }}", fields.join("; ")))
}

pub(super) fn properties() -> Result<WriterProperties> {
    let mut properties = WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_2_0)
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(ZSTD)?))
        .set_created_by(concat!("crepitus ", env!("CARGO_PKG_VERSION")).to_owned())
        // Nothing in the file that our own reader does not check.
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true);
    for column in &COLUMNS {
        if let Some(encoding) = encoding_of(column) {
            properties = properties
                .set_column_encoding(ColumnPath::from(column.name), encoding)
                .set_column_dictionary_enabled(ColumnPath::from(column.name), false);
        }
    }
    Ok(properties.build())
}

/// Writes rows as one group, column by column.
pub(super) fn write<W: Write + Send>(
    rows: &[Row],
    group: &mut SerializedRowGroupWriter<'_, W>,
) -> Result<()> {
    // Few of the words differ.
    let mut places = HashMap::new();
    let mut indices = Vec::with_capacity(rows.len());
    let mut known = Vec::new();
    for row in rows {
        let index = *places.entry((row.flags.0, row.phases)).or_insert_with(|| {
            known.push(words::of(row).map(|word| ByteArray::from(word.into_bytes())));
            known.len() - 1
        });
        indices.push(index);
    }
    let mut words = 0;
    for described in &COLUMNS {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        let column_ref = &mut column;
        match described.cell {
            Cell::U64(get, _) => put::<Int64Type>(column_ref, rows, |row| get(row).cast_signed())?,
            Cell::U32(get, _) => put::<Int32Type>(column_ref, rows, |row| get(row).cast_signed())?,
            Cell::I32(get, _) => put::<Int32Type>(column_ref, rows, get)?,
            Cell::F64(get, _) => put::<DoubleType>(column_ref, rows, get)?,
            Cell::F32(get, _) => put::<FloatType>(column_ref, rows, get)?,
            Cell::Measured(get, _) => put_known(column_ref, rows, get)?,
            Cell::Word(_) => {
                let values = indices.iter().map(|index| known[*index][words].clone());
                text(column_ref, &values.collect::<Vec<_>>())?;
                words += 1;
            }
        }
        column.close()?;
    }
    Ok(())
}

fn put<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    rows: &[Row],
    value: impl Fn(&Row) -> T::T,
) -> Result<()> {
    let values: Vec<_> = rows.iter().map(value).collect();
    column.typed::<T>().write_batch(&values, None, None)?;
    Ok(())
}

/// Values that a row need not have.
fn put_known(
    column: &mut SerializedColumnWriter<'_>,
    rows: &[Row],
    value: impl Fn(&Row) -> Option<f32>,
) -> Result<()> {
    let levels: Vec<_> = rows
        .iter()
        .map(|row| i16::from(value(row).is_some()))
        .collect();
    let values: Vec<_> = rows.iter().filter_map(value).collect();
    column
        .typed::<FloatType>()
        .write_batch(&values, Some(&levels), None)?;
    Ok(())
}

fn text(column: &mut SerializedColumnWriter<'_>, values: &[ByteArray]) -> Result<()> {
    if let ColumnWriter::ByteArrayColumnWriter(writer) = column.untyped() {
        writer.write_batch(values, None, None)?;
    }
    Ok(())
}

/// Reads the rows of a group.
pub(super) fn read<R: ChunkReader + 'static>(
    bytes: &Arc<R>,
    group: &RowGroupMetaData,
) -> io::Result<Vec<Row>> {
    let count = usize::try_from(group.num_rows()).map_err(io::Error::other)?;
    // Before there is memory for them.
    if count > GROUP_ROWS {
        return Err(implausible(format!(
            "a group says that it has {count} rows, and at most {GROUP_ROWS} are written"
        )));
    }
    let mut rows = vec![Row::default(); count];
    let mut texts: [Vec<ByteArray>; 4] = [const { Vec::new() }; 4];
    let mut words = texts.iter_mut();
    for described in &COLUMNS {
        let mut chunks = group.columns().iter();
        let Some(chunk) = chunks.find(|chunk| chunk.column_descr().name() == described.name) else {
            // Written before there was this column; flags are made of all words.
            if let Cell::Word(_) = described.cell {
                return Err(implausible(format!("it has no column {}", described.name)));
            }
            continue;
        };
        let column = Chunk {
            bytes,
            about: chunk,
            count,
        };
        let rows = &mut rows;
        match described.cell {
            Cell::U64(_, set) => {
                column.get::<Int64Type>(rows, |row, v| set(row, v.cast_unsigned()))?;
            }
            Cell::U32(_, set) => {
                column.get::<Int32Type>(rows, |row, v| set(row, v.cast_unsigned()))?;
            }
            Cell::I32(_, set) => column.get::<Int32Type>(rows, set)?,
            Cell::F64(_, set) => column.get::<DoubleType>(rows, set)?,
            Cell::F32(_, set) | Cell::Measured(_, set) => column.get::<FloatType>(rows, set)?,
            Cell::Word(_) => {
                if let Some(texts) = words.next() {
                    *texts = column.values::<ByteArrayType>()?.0;
                }
            }
        }
    }
    set_flags(&mut rows, &texts)?;
    let end_s = seconds(END_TICK);
    let is_plausible = |row: &Row| row.tick < END_TICK && (0.0..end_s).contains(&row.time_s);
    if let Some(row) = rows.iter().find(|row| !is_plausible(row)) {
        return Err(implausible(format!(
            "tick {} at {} s is later than any device counts",
            row.tick, row.time_s
        )));
    }
    Ok(rows)
}

fn implausible(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// Sets the flags from the words: few of them differ.
fn set_flags(rows: &mut [Row], columns: &[Vec<ByteArray>; 4]) -> io::Result<()> {
    let mut last: Option<([&ByteArray; 4], _)> = None;
    for (at, row) in rows.iter_mut().enumerate() {
        let [Some(phase), Some(event), Some(limit), Some(notes)] =
            columns.each_ref().map(|words| words.get(at))
        else {
            return Err(short());
        };
        let of_row = [phase, event, limit, notes];
        let read = match last {
            Some((same, read)) if same == of_row => read,
            _ => {
                let mut text = words::Words::default();
                for (text, word) in text.iter_mut().zip(of_row) {
                    word.as_utf8().map_err(other)?.clone_into(text);
                }
                words::read(&text)?
            }
        };
        last = Some((of_row, read));
        (row.flags, row.phases) = read;
    }
    Ok(())
}

fn short() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "a column has too few values")
}

struct Chunk<'g, R> {
    bytes: &'g Arc<R>,
    about: &'g ColumnChunkMetaData,
    count: usize,
}

impl<R: ChunkReader + 'static> Chunk<'_, R> {
    /// Values of the column, and for each row whether it has one.
    fn values<T: DataType>(&self) -> io::Result<(Vec<T::T>, Vec<i16>)> {
        let Self {
            bytes,
            about,
            count,
        } = *self;
        if about.column_type() != T::get_physical_type() {
            let name = about.column_descr().name();
            return Err(implausible(format!("column {name} has another type")));
        }
        let pages = SerializedPageReader::new(bytes.clone(), about, count, None).map_err(other)?;
        let reader = get_column_reader(about.column_descr_ptr(), Box::new(pages));
        let mut reader = get_typed_column_reader::<T>(reader);
        let (mut values, mut levels) = (Vec::with_capacity(self.count), Vec::new());
        let (rows, _, _) = reader
            .read_records(self.count, Some(&mut levels), None, &mut values)
            .map_err(other)?;
        if rows == self.count {
            Ok((values, levels))
        } else {
            Err(short())
        }
    }

    fn get<T: DataType>(
        &self,
        rows: &mut [Row],
        mut set: impl FnMut(&mut Row, T::T),
    ) -> io::Result<()> {
        let (values, levels) = self.values::<T>()?;
        // No levels: every row has a value.
        let has_value = |at: usize| levels.get(at) != Some(&0);
        let with_value = rows
            .iter_mut()
            .enumerate()
            .filter_map(|(at, row)| has_value(at).then_some(row));
        for (row, value) in with_value.zip(values) {
            set(row, value);
        }
        Ok(())
    }
}

//! Columns of the file: the same as those of CSV.

use super::{GROUP_ROWS, other, words};
use crate::row::{COLUMNS, END_TICK, Row, seconds};
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::column::reader::{get_column_reader, get_typed_column_reader};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::{
    ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::Result;
use parquet::file::metadata::RowGroupMetaData;
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

/// Columns of fractions.
const FLOATS: [&str; 7] = [
    "t_s",
    "angle_rad",
    "omega_rad_s",
    "model_torque_nm",
    "torque_nm",
    "current_a",
    "coil_current_a",
];

/// The type of each column.
fn type_of(name: &str) -> &'static str {
    match name {
        "tick" => "required int64 tick (INTEGER(64, false))",
        "t_s" => "required double t_s",
        "count" => "required int32 count",
        "angle_rad" => "required double angle_rad",
        "omega_rad_s" => "required float omega_rad_s",
        "model_torque_nm" => "required float model_torque_nm",
        "torque_nm" => "required float torque_nm",
        "current_a" => "optional float current_a",
        "coil_current_a" => "optional float coil_current_a",
        "revision" => "required int32 revision (INTEGER(32, false))",
        "phase" => "required binary phase (UTF8)",
        "event" => "required binary event (UTF8)",
        "limit" => "required binary limit (UTF8)",
        _ => "required binary notes (UTF8)",
    }
}

pub(super) fn schema() -> Result<Type> {
    let fields: Vec<_> = COLUMNS.iter().map(|(name, _)| type_of(name)).collect();
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
    for (names, encoding) in [
        (&GROWING[..], Encoding::DELTA_BINARY_PACKED),
        (&FLOATS[..], Encoding::BYTE_STREAM_SPLIT),
    ] {
        for name in names {
            properties = properties
                .set_column_encoding(ColumnPath::from(*name), encoding)
                .set_column_dictionary_enabled(ColumnPath::from(*name), false);
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
    for (name, _) in COLUMNS {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        let word = |which: usize| -> Vec<ByteArray> {
            indices
                .iter()
                .map(|index| known[*index][which].clone())
                .collect()
        };
        match name {
            "tick" => put::<Int64Type>(&mut column, rows, |row| row.tick.cast_signed())?,
            "t_s" => put::<DoubleType>(&mut column, rows, |row| row.time_s)?,
            "count" => put::<Int32Type>(&mut column, rows, |row| row.count)?,
            "angle_rad" => put::<DoubleType>(&mut column, rows, |row| row.angle_rad)?,
            "omega_rad_s" => put::<FloatType>(&mut column, rows, |row| row.omega_rad_s)?,
            "model_torque_nm" => put::<FloatType>(&mut column, rows, |row| row.model_torque_nm)?,
            "torque_nm" => put::<FloatType>(&mut column, rows, |row| row.torque_nm)?,
            "revision" => put::<Int32Type>(&mut column, rows, |row| row.revision.cast_signed())?,
            "current_a" => put_known(&mut column, rows, |row| row.current_a)?,
            "coil_current_a" => put_known(&mut column, rows, |row| row.coil_a)?,
            "phase" => text(&mut column, &word(0))?,
            "event" => text(&mut column, &word(1))?,
            "limit" => text(&mut column, &word(2))?,
            _ => text(&mut column, &word(3))?,
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
    for (at, (name, _)) in COLUMNS.iter().enumerate() {
        let column = Column {
            bytes,
            group,
            at,
            count,
        };
        match *name {
            "tick" => column.get::<Int64Type>(&mut rows, |row, v| row.tick = v.cast_unsigned())?,
            "t_s" => column.get::<DoubleType>(&mut rows, |row, v| row.time_s = v)?,
            "count" => column.get::<Int32Type>(&mut rows, |row, v| row.count = v)?,
            "angle_rad" => column.get::<DoubleType>(&mut rows, |row, v| row.angle_rad = v)?,
            "omega_rad_s" => column.get::<FloatType>(&mut rows, |row, v| row.omega_rad_s = v)?,
            "model_torque_nm" => {
                column.get::<FloatType>(&mut rows, |row, v| row.model_torque_nm = v)?;
            }
            "torque_nm" => column.get::<FloatType>(&mut rows, |row, v| row.torque_nm = v)?,
            "revision" => {
                column.get::<Int32Type>(&mut rows, |row, v| row.revision = v.cast_unsigned())?;
            }
            "current_a" => column.get::<FloatType>(&mut rows, |row, v| row.current_a = Some(v))?,
            "coil_current_a" => {
                column.get::<FloatType>(&mut rows, |row, v| row.coil_a = Some(v))?;
            }
            "phase" => texts[0] = column.values::<ByteArrayType>()?.0,
            "event" => texts[1] = column.values::<ByteArrayType>()?.0,
            "limit" => texts[2] = column.values::<ByteArrayType>()?.0,
            _ => texts[3] = column.values::<ByteArrayType>()?.0,
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

struct Column<'g, R> {
    bytes: &'g Arc<R>,
    group: &'g RowGroupMetaData,
    at: usize,
    count: usize,
}

impl<R: ChunkReader + 'static> Column<'_, R> {
    /// Its values, and for each row whether it has one.
    fn values<T: DataType>(&self) -> io::Result<(Vec<T::T>, Vec<i16>)> {
        let chunk = self.group.columns().get(self.at).ok_or_else(short)?;
        let pages = SerializedPageReader::new(self.bytes.clone(), chunk, self.count, None)
            .map_err(other)?;
        let reader = get_column_reader(chunk.column_descr_ptr(), Box::new(pages));
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

//! The table as a Parquet file. Every column but the index is optional: a run that
//! failed has a reason instead of numbers.

use super::{Chunk, Content, INDEX, Rows, TableError};
use crate::sweep::kind::Kind;
use crate::sweep::parts::{Cells, Column};
use crate::sweep::plan::Identity;
use crate::sweep::row::Cell;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::Field;
use parquet::schema::types::Type;
use std::io::{self, Write};
use std::mem::take;
use std::sync::Arc;

/// Rows that are in memory before they are written as a group.
const GROUP_ROWS: usize = 20_000;

/// Level of zstd: higher ones are slower and hardly smaller.
const ZSTD: i32 = 3;

/// Key of the metadata that says which sweep this is, as JSON.
const KEY: &str = "crepitus_sweep";

impl Rows<'_> {
    pub(super) fn write_parquet(
        &self,
        file: impl Write + Send,
        identity: &Identity,
        seen: &mut dyn FnMut(&Chunk, f64) -> bool,
    ) -> std::result::Result<(), TableError> {
        let schema = Arc::new(self.schema().map_err(other)?);
        let properties = Arc::new(properties(identity).map_err(other)?);
        let file = io::BufWriter::with_capacity(1 << 16, file);
        let mut writer = SerializedFileWriter::new(file, schema, properties).map_err(other)?;
        let (mut waiting, mut rows) = (Vec::new(), 0);
        self.each_chunk(seen, &mut |chunk| {
            rows += chunk.rows();
            waiting.push(chunk);
            if rows >= GROUP_ROWS {
                rows = 0;
                self.group(&mut writer, &take(&mut waiting))
                    .map_err(other)?;
            }
            Ok(())
        })?;
        if !waiting.is_empty() {
            self.group(&mut writer, &waiting).map_err(other)?;
        }
        writer.into_inner().map_err(other)?.flush()?;
        Ok(())
    }

    fn schema(&self) -> Result<Type> {
        let index = Type::primitive_type_builder(INDEX, Physical::INT64)
            .with_repetition(Repetition::REQUIRED)
            .build()?;
        let mut fields = vec![Arc::new(index)];
        for field in &self.fields {
            let (physical, logical) = match field.kind {
                Kind::Whole => (Physical::INT64, None),
                Kind::Number => (Physical::DOUBLE, None),
                Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            };
            let field = Type::primitive_type_builder(&field.name, physical)
                .with_repetition(Repetition::OPTIONAL)
                .with_logical_type(logical)
                .build()?;
            fields.push(Arc::new(field));
        }
        Type::group_type_builder("sweep")
            .with_fields(fields)
            .build()
    }

    /// Writes rows as one group, column by column.
    fn group<W: Write + Send>(
        &self,
        writer: &mut SerializedFileWriter<W>,
        chunks: &[Chunk],
    ) -> Result<()> {
        let mut group = writer.next_row_group()?;
        if let Some(mut column) = group.next_column()? {
            let points = chunks.iter().flat_map(|chunk| chunk.points.clone());
            let points: Vec<_> = points.map(u64::cast_signed).collect();
            column
                .typed::<Int64Type>()
                .write_batch(&points, None, None)?;
            column.close()?;
        }
        for (place, field) in self.fields.iter().enumerate() {
            let group = &mut group;
            match field.kind {
                Kind::Whole => put::<Int64Type, _>(group, chunks, place, |t| t.parse().ok()),
                Kind::Number => put::<DoubleType, _>(group, chunks, place, |t| t.parse().ok()),
                Kind::Text => {
                    put::<ByteArrayType, _>(group, chunks, place, |t| Some(ByteArray::from(t)))
                }
            }?;
        }
        group.close()?;
        Ok(())
    }
}

/// A column of a group; a cell that is empty has definition level 0.
fn put<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    chunks: &[Chunk],
    place: usize,
    parse: impl Fn(&str) -> Option<T::T>,
) -> Result<()> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("a column is missing".to_owned()));
    };
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    for chunk in chunks {
        for row in 0..chunk.rows() {
            let text = chunk.cell(place, row);
            if text.is_empty() {
                levels.push(0);
                continue;
            }
            let value = parse(text).ok_or_else(|| {
                ParquetError::General(format!("{text:?} is not what its column holds"))
            })?;
            values.push(value);
            levels.push(1);
        }
    }
    column
        .typed::<T>()
        .write_batch(&values, Some(&levels), None)?;
    column.close()
}

fn properties(identity: &Identity) -> Result<WriterProperties> {
    let about =
        serde_json::to_string(identity).map_err(|e| ParquetError::General(e.to_string()))?;
    Ok(WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_2_0)
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(ZSTD)?))
        .set_created_by(concat!("crepitus ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(vec![KeyValue::new(KEY.to_owned(), about)]))
        .build())
}

fn other(error: ParquetError) -> io::Error {
    io::Error::other(error)
}

/// Reads a table back, with cells as text.
pub(super) fn read(file: std::fs::File) -> io::Result<Content> {
    let reader = SerializedFileReader::new(file).map_err(other)?;
    let mut content = Content::default();
    let mut cells: Vec<Vec<String>> = Vec::new();
    let schema = reader.metadata().file_metadata().schema_descr();
    for column in schema.columns().iter().skip(1) {
        content.columns.push(Column {
            name: column.name().to_owned(),
            kind: match column.physical_type() {
                Physical::INT64 => Kind::Whole,
                Physical::DOUBLE => Kind::Number,
                _ => Kind::Text,
            },
            cells: Cells::Each(Vec::new()),
        });
        cells.push(Vec::new());
    }
    for row in reader.get_row_iter(None).map_err(other)? {
        let row = row.map_err(other)?;
        let mut fields = row.get_column_iter();
        if let Some((_, Field::Long(index))) = fields.next() {
            content.index.push(index.cast_unsigned());
        }
        for (cells, (_, field)) in cells.iter_mut().zip(fields) {
            cells.push(match field {
                Field::Long(whole) => Cell::Whole(*whole).to_string(),
                Field::Double(number) => Cell::Number(*number).to_string(),
                Field::Str(text) => text.clone(),
                _ => String::new(),
            });
        }
    }
    for (column, cells) in content.columns.iter_mut().zip(cells) {
        column.cells = Cells::Each(cells);
    }
    Ok(content)
}

//! Rows of a sweep, read back from its table or its parts.

use super::{INDEX, Rows, TableError, without_overlaps};
use crate::sweep::kind::Kind;
use crate::sweep::parts::{Cells, Column, Parts};
use crate::sweep::plan::Identity;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

/// Rows of a sweep by column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Content {
    /// Number of the point of each row.
    pub index: Vec<u64>,
    /// Columns, with a cell per row.
    pub columns: Vec<Column>,
}

/// Reads a table that a sweep has written. In a table of CSV a number without a point is a whole one, as it was
/// written.
///
/// # Errors
/// If the file cannot be read as a table.
pub fn read(file: &Path) -> Result<Content, TableError> {
    #[cfg(feature = "parquet")]
    if file.extension().is_some_and(|ending| ending == "parquet") {
        return Ok(super::parquet::read(File::open(file)?)?);
    }
    let mut reader = csv::Reader::from_reader(BufReader::new(File::open(file)?));
    let names: Vec<_> = (reader.headers().map_err(io::Error::from)?.iter())
        .map(str::to_owned)
        .collect();
    if names.first().is_none_or(|name| name != INDEX) {
        return Err(no_table("its first column is not `index`"));
    }
    let mut index = Vec::new();
    let mut cells = vec![Vec::new(); names.len() - 1];
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).map_err(io::Error::from)? {
        let point = row.get(0).and_then(|cell| cell.parse().ok());
        index.push(point.ok_or_else(|| no_table("an `index` is not a whole number"))?);
        for (cells, cell) in cells.iter_mut().zip(row.iter().skip(1)) {
            cells.push(cell.to_owned());
        }
    }
    let columns = names.into_iter().skip(1).zip(cells);
    let columns = columns.map(|(name, cells)| Column {
        name,
        kind: kind_of(&cells),
        cells: Cells::Each(cells),
    });
    Ok(Content {
        index,
        columns: columns.collect(),
    })
}

/// Reads the rows of all parts, in the order of their points.
///
/// # Errors
/// If a part is not as it was written, or cannot be read.
pub fn of_parts(parts: &Parts, identity: &Identity) -> Result<Content, TableError> {
    let rows = Rows {
        parts,
        points: without_overlaps(&parts.points()?, identity.runs),
        fields: Vec::new(),
    };
    let rows = rows.with_fields(&mut |_| true)?;
    let mut index = Vec::new();
    let mut cells = vec![Vec::new(); rows.fields.len()];
    rows.each_chunk(&mut |_, _| true, &mut |chunk| {
        index.extend(chunk.points.clone());
        for (field, cells) in cells.iter_mut().enumerate() {
            cells.extend((0..chunk.rows()).map(|row| chunk.cell(field, row).to_owned()));
        }
        Ok(())
    })?;
    let columns = rows.fields.iter().zip(cells).map(|(field, cells)| Column {
        name: field.name.clone(),
        kind: field.kind,
        cells: Cells::Each(cells),
    });
    Ok(Content {
        index,
        columns: columns.collect(),
    })
}

/// Returns the kind of the cells of a column; empty ones are of any kind.
fn kind_of(cells: &[String]) -> Kind {
    let mut kinds = cells.iter().filter(|cell| !cell.is_empty()).map(|cell| {
        if cell.parse::<i64>().is_ok() {
            Kind::Whole
        } else if cell.parse::<f64>().is_ok() {
            Kind::Number
        } else {
            Kind::Text
        }
    });
    let first = kinds.next().unwrap_or(Kind::Text);
    kinds.fold(first, Kind::and)
}

fn no_table(why: &str) -> TableError {
    let message = format!("this is not the table of a sweep: {why}");
    io::Error::new(io::ErrorKind::InvalidData, message).into()
}

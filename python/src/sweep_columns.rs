//! Rows of a sweep as arrays.

use crepitus_studies::sweep::kind::Kind;
use crepitus_studies::sweep::{Cell, Content, Row};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::collections::HashMap;

/// Converts rows to columns, in the order in which they first appear. A missing number is NaN, a
/// missing text empty.
pub(crate) fn of_rows(py: Python<'_>, rows: Vec<Row>) -> PyResult<Bound<'_, PyDict>> {
    let count = rows.len();
    let mut places: HashMap<String, usize> = HashMap::new();
    let mut columns: Vec<(String, Kind, Vec<Option<Cell>>)> = Vec::new();
    let index: Vec<_> = rows.iter().map(|row| row.index).collect();
    for (number, row) in rows.into_iter().enumerate() {
        for (name, cell) in row.cells {
            let kind = cell.kind();
            let place = *places.entry(name).or_insert_with_key(|name| {
                columns.push((name.clone(), kind, vec![None; count]));
                columns.len() - 1
            });
            let (_, of_column, cells) = &mut columns[place];
            *of_column = of_column.and(kind);
            cells[number] = Some(cell);
        }
    }
    into_dict(py, index, columns)
}

/// Converts what is in a folder, where an empty cell is a missing one.
pub(crate) fn of_content(py: Python<'_>, content: Content) -> PyResult<Bound<'_, PyDict>> {
    let rows = 0..content.index.len();
    let columns = content.columns.into_iter().map(|column| {
        let cells = rows.clone().map(|row| {
            let cell = column.cells.get(row);
            let of_kind = match column.kind {
                Kind::Whole => cell.parse().ok().map(Cell::Whole),
                Kind::Number => cell.parse().ok().map(Cell::Number),
                Kind::Text => Some(Cell::Text(cell.to_owned())),
            };
            of_kind.filter(|_| !cell.is_empty())
        });
        let cells = cells.collect();
        (column.name, column.kind, cells)
    });
    into_dict(py, content.index, columns.collect())
}

fn into_dict(
    py: Python<'_>,
    index: Vec<u64>,
    columns: Vec<(String, Kind, Vec<Option<Cell>>)>,
) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let index: Vec<_> = index.into_iter().map(u64::cast_signed).collect();
    dict.set_item("index", index.into_pyarray(py))?;
    for (name, kind, cells) in columns {
        let is_full = cells.iter().all(Option::is_some);
        match kind {
            Kind::Whole if is_full => {
                let whole = cells.iter().map(|cell| match cell {
                    Some(Cell::Whole(whole)) => *whole,
                    _ => 0,
                });
                dict.set_item(name, whole.collect::<Vec<_>>().into_pyarray(py))?;
            }
            Kind::Whole | Kind::Number => {
                let numbers = cells.iter().map(Option::as_ref).map(number);
                dict.set_item(name, numbers.collect::<Vec<_>>().into_pyarray(py))?;
            }
            Kind::Text => {
                let texts = cells.into_iter().map(|cell| match cell {
                    Some(cell) => cell.to_string(),
                    None => String::new(),
                });
                dict.set_item(name, PyList::new(py, texts.collect::<Vec<_>>())?)?;
            }
        }
    }
    Ok(dict)
}

#[expect(clippy::cast_precision_loss, reason = "counts are below 2^53")]
fn number(cell: Option<&Cell>) -> f64 {
    match cell {
        Some(Cell::Whole(whole)) => *whole as f64,
        Some(Cell::Number(number)) => *number,
        Some(Cell::Text(_)) | None => f64::NAN,
    }
}

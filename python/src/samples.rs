//! Samples of a device by column, as they come or from a recording.

use crate::columns::words;
use crate::errors;
use crate::signals::Signals;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_recording::{COLUMNS, Cell, Damage, Recording, Row};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;

/// Samples by column, with the names of a recording's columns. A value that was not measured is
/// NaN; the phase is a number, and of the notes there are those that are flags.
pub(crate) struct Samples {
    columns: Vec<(&'static str, Values)>,
    rows: usize,
}

/// The values of a column.
enum Values {
    U64(fn(&Row) -> u64, Vec<u64>),
    U32(fn(&Row) -> u32, Vec<u32>),
    I32(fn(&Row) -> i32, Vec<i32>),
    F64(fn(&Row) -> f64, Vec<f64>),
    F32(fn(&Row) -> f32, Vec<f32>),
    Measured(fn(&Row) -> Option<f32>, Vec<f32>),
    I8(fn(&Row) -> i8, Vec<i8>),
    Word(fn(&Row) -> &'static str, Vec<&'static str>),
    Flag(u16, Vec<bool>),
}

/// The notes that are flags.
const FLAGS: [(&str, u16); 3] = [
    ("settling", SampleFlags::SETTLING),
    ("lost", SampleFlags::LOST),
    ("late", SampleFlags::LATE),
];

impl Default for Samples {
    fn default() -> Self {
        let columns = COLUMNS.iter().filter_map(|column| {
            let values = match (column.name, column.cell) {
                ("phase", _) => Values::I8(|row| row.flags.phase_sign(), Vec::new()),
                ("event", _) => Values::Word(Row::event, Vec::new()),
                ("limit", _) => Values::Word(|row| row.flags.limit().name(), Vec::new()),
                (_, Cell::U64(get, _)) => Values::U64(get, Vec::new()),
                (_, Cell::U32(get, _)) => Values::U32(get, Vec::new()),
                (_, Cell::I32(get, _)) => Values::I32(get, Vec::new()),
                (_, Cell::F64(get, _)) => Values::F64(get, Vec::new()),
                (_, Cell::F32(get, _)) => Values::F32(get, Vec::new()),
                (_, Cell::Measured(get, _)) => Values::Measured(get, Vec::new()),
                (_, Cell::Word(_)) => return None,
            };
            Some((column.name, values))
        });
        let flags = FLAGS.map(|(name, bit)| (name, Values::Flag(bit, Vec::new())));
        Self {
            columns: columns.chain(flags).collect(),
            rows: 0,
        }
    }
}

impl Samples {
    pub(crate) fn is_empty(&self) -> bool {
        self.rows == 0
    }

    pub(crate) fn push(&mut self, row: &Row) {
        self.rows += 1;
        for (_, values) in &mut self.columns {
            match values {
                Values::U64(get, all) => all.push(get(row)),
                Values::U32(get, all) => all.push(get(row)),
                Values::I32(get, all) => all.push(get(row)),
                Values::F64(get, all) => all.push(get(row)),
                Values::F32(get, all) => all.push(get(row)),
                Values::Measured(get, all) => all.push(get(row).unwrap_or(f32::NAN)),
                Values::I8(get, all) => all.push(get(row)),
                Values::Word(get, all) => all.push(get(row)),
                Values::Flag(bit, all) => all.push(row.flags.has(*bit)),
            }
        }
    }

    pub(crate) fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        for (name, values) in self.columns {
            match values {
                Values::U64(_, all) => dict.set_item(name, all.into_pyarray(py))?,
                Values::U32(_, all) => dict.set_item(name, all.into_pyarray(py))?,
                Values::I32(_, all) => dict.set_item(name, all.into_pyarray(py))?,
                Values::F64(_, all) => dict.set_item(name, all.into_pyarray(py))?,
                Values::F32(_, all) | Values::Measured(_, all) => {
                    dict.set_item(name, all.into_pyarray(py))?;
                }
                Values::I8(_, all) => dict.set_item(name, all.into_pyarray(py))?,
                Values::Word(_, all) => dict.set_item(name, words(py, &all))?,
                Values::Flag(_, all) => dict.set_item(name, all.into_pyarray(py))?,
            }
        }
        Ok(dict)
    }
}

/// Reads a recording; returns its samples, and title, devices and accounting (JSON).
#[pyfunction]
pub(crate) fn read_recording(
    py: Python<'_>,
    path: PathBuf,
) -> PyResult<(Bound<'_, PyDict>, String)> {
    let (samples, about) = py.detach(|| {
        let failed = |error: crepitus_recording::ReadError| errors::device(error.to_string());
        let mut signals = Signals::new();
        let mut samples = Samples::default();
        let recording = Recording::open(&path, Damage::Refuse).map_err(failed)?;
        for row in recording.rows().map_err(failed)? {
            samples.push(&row.map_err(failed)?);
            if samples.rows.is_multiple_of(10_000) {
                signals.check()?;
            }
        }
        let about = json!({
            "metadata": recording.metadata(),
            "books": recording.accounting(),
            "complete": recording.is_complete(),
            "warnings": recording.warnings(),
        });
        Ok::<_, PyErr>((samples, about.to_string()))
    })?;
    Ok((samples.into_dict(py)?, about))
}

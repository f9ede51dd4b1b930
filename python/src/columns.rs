//! Columns of a run as arrays that own their numbers.

use crepitus_scene::trace::{Column, ColumnKind, EventRecord, SymptomEvent};
use numpy::{IntoPyArray, PyFixedUnicode};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Rows of a trace, by column.
pub(crate) struct Trace {
    columns: Vec<Column>,
    numbers: Vec<Vec<f64>>,
}

impl Trace {
    /// Creates columns with memory for `rows` rows, so that none is reallocated.
    pub(crate) fn new(columns: Vec<Column>, rows: u64) -> PyResult<Self> {
        let mut numbers = vec![Vec::new(); columns.len()];
        let count = usize::try_from(rows).unwrap_or(usize::MAX);
        let too_large = |_| {
            PyMemoryError::new_err(format!(
                "the trace of {} columns and {rows} rows does not fit into memory: thin it with trace_every or \
                 output.trace_step_s, or leave it out with trace=False",
                columns.len()
            ))
        };
        // All of it at once: a system may promise each column by itself.
        let whole = count.saturating_mul(columns.len());
        Vec::<f64>::new()
            .try_reserve_exact(whole)
            .map_err(too_large)?;
        for column in &mut numbers {
            column.try_reserve_exact(count).map_err(too_large)?;
        }
        Ok(Self { columns, numbers })
    }

    pub(crate) fn row(&mut self, values: &[f64]) {
        for (column, value) in self.numbers.iter_mut().zip(values) {
            column.push(*value);
        }
    }

    /// Converts to a dict of arrays. Numbers are handed over without a copy; phases and whole
    /// numbers become integers.
    pub(crate) fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        for (column, numbers) in self.columns.iter().zip(self.numbers) {
            let name = column.name;
            match column.kind {
                ColumnKind::Number => dict.set_item(name, numbers.into_pyarray(py))?,
                ColumnKind::Phase => {
                    #[expect(clippy::cast_possible_truncation, reason = "-1, 0, 1")]
                    let signs: Vec<_> = numbers.iter().map(|x| *x as i8).collect();
                    dict.set_item(name, signs.into_pyarray(py))?;
                }
                ColumnKind::Whole => {
                    #[expect(clippy::cast_possible_truncation, reason = "whole, and small")]
                    let whole: Vec<_> = numbers.iter().map(|x| *x as i64).collect();
                    dict.set_item(name, whole.into_pyarray(py))?;
                }
            }
        }
        Ok(dict)
    }
}

/// Events of a run, by column, as `events.csv` has them; NaN where that is empty.
#[derive(Default)]
pub(crate) struct Events {
    time_s: Vec<f64>,
    effect: Vec<&'static str>,
    event: Vec<&'static str>,
    angle_rad: Vec<f64>,
    theta_rad: Vec<f64>,
    omega_rad_s: Vec<f64>,
    torque_before_nm: Vec<f64>,
    torque_after_nm: Vec<f64>,
}

impl Events {
    pub(crate) fn event(&mut self, event: &EventRecord) {
        self.time_s.push(event.time_s);
        self.effect.push("crepitus");
        self.event.push(event.kind.name());
        self.angle_rad.push(f64::NAN);
        self.theta_rad.push(event.theta_rad);
        self.omega_rad_s.push(event.omega_rad_s);
        self.torque_before_nm.push(event.torque_before_nm);
        self.torque_after_nm.push(event.torque_after_nm);
    }

    pub(crate) fn symptom(&mut self, event: &SymptomEvent) {
        self.time_s.push(event.time_s);
        self.effect.push(event.effect);
        self.event.push(event.word.name());
        self.angle_rad.push(event.angle_rad);
        self.theta_rad.push(f64::NAN);
        self.omega_rad_s.push(event.omega_rad_s);
        self.torque_before_nm.push(event.torque_before_nm);
        self.torque_after_nm.push(event.torque_after_nm);
    }

    pub(crate) fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("t_s", self.time_s.into_pyarray(py))?;
        dict.set_item("effect", words(py, &self.effect))?;
        dict.set_item("event", words(py, &self.event))?;
        dict.set_item("angle_rad", self.angle_rad.into_pyarray(py))?;
        dict.set_item("theta_rad", self.theta_rad.into_pyarray(py))?;
        dict.set_item("omega_rad_s", self.omega_rad_s.into_pyarray(py))?;
        dict.set_item("torque_before_nm", self.torque_before_nm.into_pyarray(py))?;
        dict.set_item("torque_after_nm", self.torque_after_nm.into_pyarray(py))?;
        Ok(dict)
    }
}

/// Converts names to an array of fixed-width texts, no wider than needed: each character takes 4
/// bytes.
pub(crate) fn words<'py>(py: Python<'py>, words: &[&'static str]) -> Bound<'py, PyAny> {
    match words.iter().map(|w| w.chars().count()).max().unwrap_or(0) {
        0..=8 => fixed::<8>(py, words),
        9..=16 => fixed::<16>(py, words),
        _ => fixed::<32>(py, words),
    }
}

fn fixed<'py, const N: usize>(py: Python<'py>, words: &[&'static str]) -> Bound<'py, PyAny> {
    let padded = |word: &&str| {
        let mut letters = [0; N];
        for (place, letter) in letters.iter_mut().zip(word.chars()) {
            *place = u32::from(letter);
        }
        PyFixedUnicode::<N>::from(letters)
    };
    let array: Vec<_> = words.iter().map(padded).collect();
    array.into_pyarray(py).into_any()
}

//! Samples of a device by column, as they come or from a recording.

use crate::columns::words;
use crate::errors;
use crate::signals::Signals;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_recording::{Damage, Recording, Row};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;

/// Samples by column, with the names of a recording's columns. A value that was not measured is
/// NaN.
#[derive(Default)]
pub(crate) struct Samples {
    tick: Vec<u64>,
    time_s: Vec<f64>,
    count: Vec<i32>,
    angle_rad: Vec<f64>,
    omega_rad_s: Vec<f32>,
    phase: Vec<i8>,
    event: Vec<&'static str>,
    model_torque_nm: Vec<f32>,
    torque_nm: Vec<f32>,
    current_a: Vec<f32>,
    coil_current_a: Vec<f32>,
    revision: Vec<u32>,
    limit: Vec<&'static str>,
    settling: Vec<bool>,
    lost: Vec<bool>,
    late: Vec<bool>,
}

impl Samples {
    pub(crate) fn push(&mut self, row: &Row) {
        self.tick.push(row.tick);
        self.time_s.push(row.time_s);
        self.count.push(row.count);
        self.angle_rad.push(row.angle_rad);
        self.omega_rad_s.push(row.omega_rad_s);
        self.phase.push(row.flags.phase_sign());
        self.event.push(row.event());
        self.model_torque_nm.push(row.model_torque_nm);
        self.torque_nm.push(row.torque_nm);
        self.current_a.push(row.current_a.unwrap_or(f32::NAN));
        self.coil_current_a.push(row.coil_a.unwrap_or(f32::NAN));
        self.revision.push(row.revision);
        self.limit.push(row.flags.limit().name());
        self.settling.push(row.flags.has(SampleFlags::SETTLING));
        self.lost.push(row.flags.has(SampleFlags::LOST));
        self.late.push(row.flags.has(SampleFlags::LATE));
    }

    pub(crate) fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("tick", self.tick.into_pyarray(py))?;
        dict.set_item("t_s", self.time_s.into_pyarray(py))?;
        dict.set_item("count", self.count.into_pyarray(py))?;
        dict.set_item("angle_rad", self.angle_rad.into_pyarray(py))?;
        dict.set_item("omega_rad_s", self.omega_rad_s.into_pyarray(py))?;
        dict.set_item("phase", self.phase.into_pyarray(py))?;
        dict.set_item("event", words(py, &self.event))?;
        dict.set_item("model_torque_nm", self.model_torque_nm.into_pyarray(py))?;
        dict.set_item("torque_nm", self.torque_nm.into_pyarray(py))?;
        dict.set_item("current_a", self.current_a.into_pyarray(py))?;
        dict.set_item("coil_current_a", self.coil_current_a.into_pyarray(py))?;
        dict.set_item("revision", self.revision.into_pyarray(py))?;
        dict.set_item("limit", words(py, &self.limit))?;
        dict.set_item("settling", self.settling.into_pyarray(py))?;
        dict.set_item("lost", self.lost.into_pyarray(py))?;
        dict.set_item("late", self.late.into_pyarray(py))?;
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
            if samples.tick.len().is_multiple_of(10_000) {
                signals.check()?;
            }
        }
        let about = json!({
            "metadata": recording.metadata(),
            "books": recording.books(),
            "complete": recording.is_complete(),
            "warnings": recording.warnings(),
        });
        Ok::<_, PyErr>((samples, about.to_string()))
    })?;
    Ok((samples.into_dict(py)?, about))
}

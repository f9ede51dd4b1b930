//! A brace from a swinging weight, and a model of a measured knee, from files or arrays.

use crate::errors;
use crate::signals::Signals;
use crepitus_identify::DEVIATIONS;
use crepitus_identify::brace::{self, Weight};
use crepitus_identify::files::{
    AngleColumns, ExaminationColumns, FileError, SwingColumns, TorqueUnit, read_examination,
    read_swings,
};
use crepitus_identify::knee::{self, Examination};
use crepitus_plant::recording::AngleUnit;
use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Columns of time and angle: time, its unit, angle, its unit, factor and offset (deg) of the angle.
type Table = (
    Option<String>,
    Option<String>,
    Option<String>,
    Option<String>,
    f64,
    f64,
);

/// Torque of a table: column, unit, factor; inertia of a released leg, kg·m².
type Torque = (Option<String>, Option<String>, f64, Option<f64>);

/// Swinging weight: mass, kg, lever, m, inertia, kg·m², 95 % intervals of its moment and of the motor's torque
/// constant, %.
type Swung = (f64, f64, Option<f64>, f64, f64);

/// Columns of an examination: time, s, angle, rad, torque, N·m.
type Arrays<'py> = (
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
);

/// Signals during work that ends by returning false.
struct Watched {
    signals: Signals,
    raised: Option<PyErr>,
}

impl Watched {
    fn new() -> Self {
        Self {
            signals: Signals::new(),
            raised: None,
        }
    }

    fn goes_on(&mut self) -> bool {
        self.raised = self.raised.take().or(self.signals.check().err());
        self.raised.is_none()
    }

    /// Returns the exception of a handler, or else of the work.
    fn raised_or(self, otherwise: PyErr) -> PyErr {
        self.raised.unwrap_or(otherwise)
    }
}

/// Fits a model to an examination; returns result and warnings (JSON), a scene, and the curve: time, angle,
/// torque, symptom, residual.
#[pyfunction]
pub(crate) fn fit<'py>(
    py: Python<'py>,
    file: Option<PathBuf>,
    arrays: Option<Arrays<'py>>,
    table: Table,
    torque: Torque,
) -> PyResult<(String, String, Bound<'py, PyArray2<f64>>)> {
    let (torque, unit, torque_scale, released_kg_m2) = torque;
    let arrays = arrays.map(|(time, angle, torque)| Examination {
        time_s: time.as_array().to_vec(),
        angle_rad: angle.as_array().to_vec(),
        torque_nm: torque.as_array().to_vec(),
        released_kg_m2,
    });
    let columns = ExaminationColumns {
        table: angle_columns(table)?,
        torque,
        torque_unit: unit.as_deref().map(torque_unit).transpose()?,
        torque_scale,
        released_kg_m2,
    };
    let (summary, scene, curve) = py.detach(|| {
        let mut warnings = Vec::new();
        let file = file.as_deref().unwrap_or(Path::new("arrays"));
        let examination = match arrays {
            Some(examination) => examination,
            None => read_examination(file, &columns, &mut |text| warnings.push(text.to_owned()))
                .map_err(unread)?,
        };
        let mut watched = Watched::new();
        let found = knee::fit(&examination, &mut |_| watched.goes_on());
        let fitted =
            found.map_err(|refusal| watched.raised_or(errors::refusal(in_python(&refusal))))?;
        let grade = knee::grade(&fitted);
        let summary = json!({
            "fit": knee::summary(&fitted, grade.as_ref()),
            "warnings": warnings,
        });
        let scene = knee::scene(&fitted, grade.as_ref(), file);
        let curve: Vec<_> = fitted.curve().map(Vec::from).collect();
        Ok::<_, PyErr>((summary.to_string(), scene, curve))
    })?;
    let curve = PyArray2::from_vec2(py, &curve)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok((summary, scene, curve))
}

/// Identifies a brace; returns values and warnings (JSON), and the tables of a scene.
#[pyfunction]
pub(crate) fn identify(
    py: Python<'_>,
    files: Vec<PathBuf>,
    weight: Swung,
    table: Table,
    current: Option<String>,
    nm_per_a: f64,
) -> PyResult<(String, String)> {
    let (mass_kg, lever_m, inertia_kg_m2, weight_percent, torque_percent) = weight;
    for (name, value) in [
        ("weight_kg", Some(mass_kg)),
        ("lever_m", Some(lever_m)),
        ("weight_inertia_kg_m2", inertia_kg_m2),
    ] {
        let is_bad = |value: &f64| !(value.is_finite() && *value > 0.0);
        if let Some(bad) = value.filter(is_bad) {
            let message = format!("{name}: expected a number above 0, got {bad}");
            return Err(PyValueError::new_err(message));
        }
    }
    let weight = Weight::new(
        mass_kg,
        lever_m,
        inertia_kg_m2,
        deviation("weight_tolerance", weight_percent)?,
    );
    let torque_deviation = deviation("torque_tolerance", torque_percent)?;
    let columns = SwingColumns {
        table: angle_columns(table)?,
        current,
        nm_per_a,
    };
    py.detach(|| {
        let mut warnings = Vec::new();
        let mut watched = Watched::new();
        let read = read_swings(
            &files,
            &columns,
            &mut |text| warnings.push(text.to_owned()),
            &mut |_| watched.goes_on(),
        );
        let recordings = match read {
            Ok(recordings) => recordings,
            Err(error) => return Err(watched.raised_or(unread(error))),
        };
        let found = brace::identify(&recordings, &weight, torque_deviation, &mut |_| {
            watched.goes_on()
        });
        let found =
            found.map_err(|refusal| watched.raised_or(errors::refusal(in_python(&refusal))))?;
        let summary = json!({
            "identified": brace::summary(&found, &weight),
            "warnings": warnings,
        });
        Ok((summary.to_string(), brace::scene::tables(&found)))
    })
}

fn angle_columns(table: Table) -> PyResult<AngleColumns> {
    let (time, time_unit, angle, unit, angle_scale, angle_offset_deg) = table;
    let unit = match unit.as_deref() {
        None => None,
        Some("deg") => Some(AngleUnit::Deg),
        Some("rad") => Some(AngleUnit::Rad),
        Some(other) => {
            let message = format!("unit: expected \"deg\" or \"rad\", got {other:?}");
            return Err(PyValueError::new_err(message));
        }
    };
    Ok(AngleColumns {
        time,
        time_unit,
        angle,
        unit,
        angle_scale,
        angle_offset_deg,
    })
}

fn torque_unit(name: &str) -> PyResult<TorqueUnit> {
    TorqueUnit::find(name).ok_or_else(|| {
        let names = TorqueUnit::ALL.map(|(name, _)| name).join(", ");
        PyValueError::new_err(format!("torque_unit: expected {names}, got {name:?}"))
    })
}

/// Returns the standard deviation, as a share, of a 95 % interval in percent.
fn deviation(name: &str, percent: f64) -> PyResult<f64> {
    if percent > 0.0 && percent <= 50.0 {
        return Ok(percent / 100.0 / DEVIATIONS);
    }
    let message = format!("{name}: expected a number above 0, up to 50 %, got {percent}");
    Err(PyValueError::new_err(message))
}

fn unread(error: FileError) -> PyErr {
    PyValueError::new_err(in_python(&error))
}

/// Returns a message with the names of the program's options as those of arguments: `--time-unit` is `time_unit`.
fn in_python(message: &impl ToString) -> String {
    let message = message.to_string();
    let mut parts = message.split("--");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '-';
        let end = part.find(|c| !is_of_name(c)).unwrap_or(part.len());
        text += &part[..end].replace('-', "_");
        text += &part[end..];
    }
    text
}

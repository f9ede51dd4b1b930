//! Measures of an examination.

use crate::signals::Signals;
use crepitus_knee::Examination;
use crepitus_knee::examination::Measure;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Samples between two checks for Ctrl-C.
const UNWATCHED_SAMPLES: usize = 100_000;

/// Measures by key, NaN where there is none, of samples: rows of time, angle, velocity and torque.
#[pyfunction]
pub(crate) fn examination<'py>(
    py: Python<'py>,
    samples: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let numbers: Vec<f64> = samples.as_array().iter().copied().collect();
    let (rows, _) = numbers.as_chunks::<4>();
    let measures = py.detach(|| {
        let mut signals = Signals::new();
        let mut examination = Examination::default();
        for rows in rows.chunks(UNWATCHED_SAMPLES) {
            for [time_s, angle_rad, omega_rad_s, torque_nm] in rows {
                examination.take(*time_s, *angle_rad, *omega_rad_s, *torque_nm);
            }
            signals.check()?;
        }
        Ok::<_, PyErr>(examination.measures())
    })?;
    let dict = PyDict::new(py);
    for (measure, value) in Measure::ALL.into_iter().zip(measures) {
        dict.set_item(measure.spec().key, value)?;
    }
    Ok(dict)
}

//! Conversion of errors to the exceptions of the package.

use crepitus_client::Error;
use crepitus_client::connection::is_input;
use crepitus_scene::SceneError;
use crepitus_scene::error::Origin;
use pyo3::PyErr;
use pyo3::exceptions::PyValueError;

mod raised {
    pyo3::import_exception!(crepitus._errors, SceneError);
    pyo3::import_exception!(crepitus._errors, RunError);
    pyo3::import_exception!(crepitus._errors, DeviceError);
    pyo3::import_exception!(crepitus._errors, Refusal);
}

/// Returns a `SceneError`. Line numbers of a scene that was made from a dict are left out: its user
/// has not written the text.
pub(crate) fn scene(error: SceneError, from_dict: bool) -> PyErr {
    let error = match error.origin {
        Some(Origin::Line(_)) if from_dict => SceneError {
            origin: None,
            ..error
        },
        _ => error,
    };
    let line = match &error.origin {
        Some(Origin::Line(line)) => Some(*line),
        _ => None,
    };
    let text = error.to_string();
    let file = error.file.display().to_string();
    raised::SceneError::new_err((text, file, line, error.key, error.message))
}

/// Returns a `RunError` for a failed run or study.
pub(crate) fn run(text: String) -> PyErr {
    raised::RunError::new_err(text)
}

/// Returns a `Refusal` for measurements that do not tell.
pub(crate) fn refusal(text: String) -> PyErr {
    raised::Refusal::new_err(text)
}

/// Returns a `DeviceError` for a device that cannot be used, or has refused.
pub(crate) fn device(text: String) -> PyErr {
    raised::DeviceError::new_err(text)
}

/// Converts the error of a request: values that no device accepts are a `ValueError`, all else a
/// `DeviceError`.
pub(crate) fn failure(error: Error) -> PyErr {
    let text = error.to_string();
    if is_input(&error) {
        PyValueError::new_err(text)
    } else {
        device(text)
    }
}

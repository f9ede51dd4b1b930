//! Conversion of Python values to TOML.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::{Table, Value};

/// Most levels of nesting, more than any scene has; ends the conversion of a list that contains
/// itself.
const MOST_LEVELS: usize = 32;

/// Converts a dict to a table.
pub(crate) fn table(dict: &Bound<'_, PyDict>) -> PyResult<Table> {
    table_at(dict, "", 0)
}

/// Converts the value at a key.
pub(crate) fn value(object: &Bound<'_, PyAny>, key: &str) -> PyResult<Value> {
    value_at(object, key, 0)
}

fn table_at(dict: &Bound<'_, PyDict>, key: &str, level: usize) -> PyResult<Table> {
    dict.iter()
        .map(|(name, object)| {
            let name = text(&name).map_err(|_| {
                PyTypeError::new_err(format!("{}: expected texts as keys", place(key)))
            })?;
            let key = if key.is_empty() {
                name.clone()
            } else {
                format!("{key}.{name}")
            };
            Ok((name, value_at(&object, &key, level + 1)?))
        })
        .collect()
}

fn value_at(object: &Bound<'_, PyAny>, key: &str, level: usize) -> PyResult<Value> {
    if level > MOST_LEVELS {
        let message = format!("{}: more than {MOST_LEVELS} levels", place(key));
        return Err(PyValueError::new_err(message));
    }
    // A `bool` is an `int`, so it comes first.
    if let Ok(flag) = object.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(number) = object.cast::<PyFloat>() {
        return Ok(Value::Float(number.extract()?));
    }
    if let Ok(number) = object.cast::<PyInt>() {
        // One that is too large for either type is infinite.
        return Ok(number.extract().map_or_else(
            |_| Value::Float(number.extract().unwrap_or(f64::INFINITY)),
            Value::Integer,
        ));
    }
    if let Ok(string) = text(object) {
        return Ok(Value::String(string));
    }
    if let Ok(dict) = object.cast::<PyDict>() {
        return Ok(Value::Table(table_at(dict, key, level)?));
    }
    if object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>() {
        let items = object.try_iter()?.enumerate();
        return items
            .map(|(n, item)| value_at(&item?, &format!("{key}[{n}]"), level + 1))
            .collect::<PyResult<_>>()
            .map(Value::Array);
    }
    // A number or an array of NumPy.
    if object.hasattr("tolist")? && object.hasattr("dtype")? {
        return value_at(&object.call_method0("tolist")?, key, level + 1);
    }
    let kind = object.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{}: expected a number, a text, True, False, a list or a dict, got {kind}",
        place(key)
    )))
}

/// Returns a text, or a path as text.
fn text(object: &Bound<'_, PyAny>) -> PyResult<String> {
    if object.hasattr("__fspath__")? {
        return object.call_method0("__fspath__")?.extract();
    }
    Ok(object.cast::<PyString>()?.to_str()?.to_owned())
}

fn place(key: &str) -> &str {
    if key.is_empty() { "the scene" } else { key }
}

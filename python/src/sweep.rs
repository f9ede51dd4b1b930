//! Many runs of a scene on all cores, a row each, as columns.

use crate::errors;
use crate::scene::{Scene, forget};
use crate::signals::Signals;
use crate::values;
use crepitus_studies::sweep::axis::Values;
use crepitus_studies::sweep::kind::Kind;
use crepitus_studies::sweep::{
    Axis, Cell, Design, Ended, Plan, Points, Receiver, Row, Sampled, run_all, totals,
};
use numpy::IntoPyArray;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString};
use std::collections::HashMap;
use std::iter::once;
use std::num::NonZero;
use std::thread::available_parallelism;

/// Receiver that collects rows and checks for Ctrl-C.
struct Rows {
    ended: Vec<Row>,
    signals: Signals,
}

/// Exception that ended a sweep.
struct Failed(PyErr);

impl From<Ended> for Failed {
    fn from(ended: Ended) -> Self {
        Self(PyOSError::new_err(match ended {
            Ended::Stopped => "the sweep was stopped".to_owned(),
            Ended::Failed(error) => error.to_string(),
            Ended::NoThread(error) => format!("no thread can be started: {error}"),
        }))
    }
}

impl Receiver for Rows {
    type Error = Failed;

    fn row(&mut self, row: Row) -> Result<(), Failed> {
        self.ended.push(row);
        Ok(())
    }

    fn poll(&mut self) -> Result<(), Failed> {
        self.signals.check().map_err(Failed)
    }
}

/// Runs points that another program has chosen, a list of values for each key.
#[pyfunction]
#[pyo3(signature = (scene, points, *, threads))]
pub(crate) fn run_points<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: &Bound<'py, PyDict>,
    threads: Option<NonZero<usize>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut paths: Vec<String> = Vec::new();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (path, column) in points {
        let path: String = path.extract()?;
        for (place, value) in column.try_iter()?.enumerate() {
            let value = values::value(&value?, &path)?.to_string();
            if rows.len() <= place {
                rows.push(Vec::new());
            }
            rows[place].push(value);
        }
        paths.push(path);
    }
    if let Some(short) = rows.iter().position(|row| row.len() != paths.len()) {
        let message = format!("points: the lists differ in length: one ends after {short} values");
        return Err(PyValueError::new_err(message));
    }
    let points = Points::new(paths, rows).map_err(|e| PyValueError::new_err(e.to_string()))?;
    run(py, scene, Design::Listed(points), threads)
}

/// Runs the points of a grid, a Latin hypercube or Sobol's sequence.
#[pyfunction]
#[pyo3(signature = (scene, vary, *, latin, sobol, seed, threads))]
pub(crate) fn run_design<'py>(
    py: Python<'py>,
    scene: &Scene,
    vary: &Bound<'py, PyDict>,
    latin: Option<u64>,
    sobol: Option<u64>,
    seed: u64,
    threads: Option<NonZero<usize>>,
) -> PyResult<Bound<'py, PyDict>> {
    let axes = vary
        .iter()
        .map(|(path, values)| axis(path.extract()?, &values))
        .collect::<PyResult<Vec<_>>>()?;
    let sampled = |count| Sampled {
        axes: axes.clone(),
        count,
        seed,
    };
    let design = match (latin, sobol) {
        (Some(_), Some(_)) => return Err(PyValueError::new_err("latin or sobol, not both")),
        (Some(count), None) => Design::latin_hypercube(sampled(count)),
        (None, Some(count)) => Design::sobol(sampled(count)),
        (None, None) => Design::grid(axes.clone()),
    };
    let design = design.map_err(|e| PyValueError::new_err(e.to_string()))?;
    run(py, scene, design, threads)
}

/// Converts `"1:4:lin7"` or a list of values to an axis.
fn axis(path: String, object: &Bound<'_, PyAny>) -> PyResult<Axis> {
    if let Ok(text) = object.cast::<PyString>() {
        let text = format!("{path}={}", text.to_str()?);
        return text
            .parse()
            .map_err(|e| PyValueError::new_err(format!("vary: {path}: {e}")));
    }
    let values = object
        .try_iter()?
        .map(|value| Ok(values::value(&value?, &path)?.to_string()))
        .collect::<PyResult<Vec<_>>>()?;
    if values.is_empty() {
        let message = format!("vary: {path}: there is no value in the list");
        return Err(PyValueError::new_err(message));
    }
    Ok(Axis {
        path,
        values: Values::List(values),
    })
}

fn run<'py>(
    py: Python<'py>,
    scene: &Scene,
    design: Design,
    threads: Option<NonZero<usize>>,
) -> PyResult<Bound<'py, PyDict>> {
    let threads = threads
        .or_else(|| available_parallelism().ok())
        .map_or(1, NonZero::get);
    let rows = py.detach(|| -> PyResult<Vec<Row>> {
        let mut overrides = scene.overrides.clone();
        // What is varied counts more than what was changed before.
        forget(&mut overrides, design.paths().into_iter());
        let plan = Plan::new(scene.source.clone(), overrides, design)
            .map_err(|error| errors::scene(error, scene.is_dict))?;
        let mut rows = Rows {
            ended: Vec::new(),
            signals: Signals::new(),
        };
        let threads = plan.threads(threads);
        run_all(
            once(0..plan.runs()),
            threads,
            &mut rows,
            |points, stop, give| totals(&plan, points, stop, give),
        )
        .map_err(|Failed(error)| error)?;
        rows.ended.sort_by_key(|row| row.index);
        Ok(rows.ended)
    })?;
    into_dict(py, rows)
}

/// Converts rows to columns, in the order in which they first appear. A missing number is NaN, a
/// missing text empty.
fn into_dict(py: Python<'_>, rows: Vec<Row>) -> PyResult<Bound<'_, PyDict>> {
    let count = rows.len();
    let mut places: HashMap<String, usize> = HashMap::new();
    let mut columns: Vec<(String, Kind, Vec<Option<Cell>>)> = Vec::new();
    let index: Vec<_> = rows.iter().map(|row| row.index.cast_signed()).collect();
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
    let dict = PyDict::new(py);
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

//! Many runs of a scene on all cores, a row each, as columns.

use crate::errors;
use crate::scene::{Scene, forget};
use crate::signals::Signals;
use crate::sweep_columns::{of_content, of_rows};
use crate::values;
use crepitus_files::output::{Claim, Inputs};
use crepitus_studies::sweep::axis::Values;
use crepitus_studies::sweep::{
    Again, Axis, Design, Ended, Format, Opening, Plan, Points, Receiver, Recipe, Row, Sampled,
    Shard, Store, StoreError, TableError, run_all, totals,
};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde_json::json;
use std::iter::once;
use std::num::NonZero;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

/// Interval of calls of a progress function.
const INTERVAL: Duration = Duration::from_millis(100);

/// Columns of the rows that there are, what sweep it is (JSON), and the exception that ended it early.
type Results<'py> = (Bound<'py, PyDict>, String, Option<PyErr>);

/// Receiver that collects rows, reports progress, and checks for Ctrl-C.
struct Rows<'s> {
    to: Place<'s>,
    done: u64,
    runs: u64,
    progress: Option<Py<PyAny>>,
    next: Instant,
    signals: Signals,
}

/// Place where rows go.
enum Place<'s> {
    Memory(Vec<Row>),
    Folder(&'s mut Store),
}

impl Rows<'_> {
    /// Calls the progress function.
    fn report(&mut self) -> PyResult<()> {
        self.next = Instant::now() + INTERVAL;
        let Some(progress) = &self.progress else {
            return Ok(());
        };
        let called = Python::try_attach(|py| progress.call1(py, (self.done, self.runs)).map(drop));
        called.unwrap_or(Ok(()))
    }
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

impl Receiver for Rows<'_> {
    type Error = Failed;

    fn row(&mut self, row: Row) -> Result<(), Failed> {
        self.done += 1;
        match &mut self.to {
            Place::Memory(rows) => rows.push(row),
            Place::Folder(store) => store.take(row).map_err(|e| Failed(failed(e)))?,
        }
        Ok(())
    }

    fn poll(&mut self) -> Result<(), Failed> {
        self.signals.check().map_err(Failed)?;
        if self.progress.is_some() && Instant::now() >= self.next {
            self.report().map_err(Failed)?;
        }
        Ok(())
    }
}

/// Threads of a sweep, its folder, whether another sweep in that is replaced, and the function that gets the
/// progress.
pub(crate) type Settings = (
    Option<NonZero<usize>>,
    Option<PathBuf>,
    bool,
    Option<Py<PyAny>>,
);

/// Runs points that another program has chosen, a list of values for each key.
#[pyfunction]
pub(crate) fn run_points<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: &Bound<'py, PyDict>,
    settings: Settings,
) -> PyResult<Results<'py>> {
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
    let plan = plan(py, scene, Design::Listed(points))?;
    run(py, plan, settings)
}

/// Runs the points of a grid, a Latin hypercube or Sobol's sequence.
#[pyfunction]
#[pyo3(signature = (scene, vary, *, latin, sobol, seed, settings))]
pub(crate) fn run_design<'py>(
    py: Python<'py>,
    scene: &Scene,
    vary: &Bound<'py, PyDict>,
    latin: Option<u64>,
    sobol: Option<u64>,
    seed: u64,
    settings: Settings,
) -> PyResult<Results<'py>> {
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
    let plan = plan(py, scene, design)?;
    run(py, plan, settings)
}

/// Runs the sweep of a folder again; also returns the differences of the programs.
#[pyfunction]
pub(crate) fn repeat(
    py: Python<'_>,
    folder: PathBuf,
    settings: Settings,
) -> PyResult<(Results<'_>, Vec<String>)> {
    let again = py.detach(|| Again::of(&folder).map_err(failed))?;
    let warnings = again.other_program(option_env!("CREPITUS_COMMIT"));
    Ok((
        run(py, again.plan, settings)?,
        warnings.into_iter().collect(),
    ))
}

/// Reads the rows of a folder.
#[pyfunction]
pub(crate) fn read_sweep(py: Python<'_>, folder: PathBuf) -> PyResult<Results<'_>> {
    let (content, about) = py.detach(|| {
        let store = Store::read(&folder).map_err(failed)?;
        let content = store.content().map_err(no_table)?;
        let about = json!({
            "sweep": store.identity(),
            "commit": store.commit(),
            "folder": folder.to_string_lossy(),
        });
        Ok::<_, PyErr>((content, about.to_string()))
    })?;
    Ok((of_content(py, content)?, about, None))
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

fn plan(py: Python<'_>, scene: &Scene, design: Design) -> PyResult<Plan> {
    py.detach(|| {
        let mut overrides = scene.overrides.clone();
        // What is varied counts more than what was changed before.
        forget(&mut overrides, design.paths().into_iter());
        Plan::new(scene.source.clone(), overrides, design)
            .map_err(|error| errors::scene(error, scene.is_dict))
    })
}

fn run(py: Python<'_>, plan: Plan, settings: Settings) -> PyResult<Results<'_>> {
    let (threads, out, force, progress) = settings;
    let commit = option_env!("CREPITUS_COMMIT");
    let about = json!({
        "sweep": plan.identity(),
        "commit": commit,
        "folder": out.as_ref().map(|out| out.to_string_lossy()),
    });
    let about = about.to_string();
    let Some(out) = out else {
        let mut rows = rows_of(Place::Memory(Vec::new()), &plan, 0, progress);
        let everything: Range<u64> = 0..plan.runs();
        let outcome = py.detach(|| run_into(&plan, once(everything), threads, &mut rows));
        let Place::Memory(mut rows) = rows.to else {
            return Err(PyOSError::new_err("the rows of a sweep are gone"));
        };
        rows.sort_by_key(|row| row.index);
        return Ok((of_rows(py, rows)?, about, outcome.err()));
    };
    let (content, outcome) = py.detach(|| {
        let mut store = open(&out, &plan, force)?;
        let outcome = run_in_folder(&plan, &mut store, threads, progress);
        Ok::<_, PyErr>((store.content().map_err(no_table)?, outcome))
    })?;
    Ok((of_content(py, content)?, about, outcome.err()))
}

/// Creates the folder of a sweep, or opens it to go on.
fn open(out: &Path, plan: &Plan, force: bool) -> PyResult<Store> {
    let claim = Claim::by("sweep").force(force);
    let opening = Opening {
        shard: Shard::WHOLE,
        format: Format::DEFAULT,
        traces: false,
        claim: claim.reading(Inputs::of(plan.inputs())),
    };
    let recipe = Recipe::of(plan, option_env!("CREPITUS_COMMIT"));
    Store::create(out, plan.identity(), &recipe, &opening).map_err(failed)
}

/// Runs what has no row yet, and makes the table; after an exception the finished rows are parts.
fn run_in_folder(
    plan: &Plan,
    store: &mut Store,
    threads: Option<NonZero<usize>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    if store.table().is_some() {
        return Ok(());
    }
    let missing = store.missing(0..plan.runs()).map_err(failed)?;
    let wanted: u64 = missing.iter().map(|range| range.end - range.start).sum();
    let done = plan.runs() - wanted;
    let mut rows = rows_of(Place::Folder(store), plan, done, progress);
    let outcome = run_into(plan, missing, threads, &mut rows);
    store.flush().map_err(failed)?;
    outcome?;
    let mut signals = Signals::new();
    let mut raised = None;
    let table = store.finish(Format::DEFAULT, &mut |_| {
        raised = signals.check().err();
        raised.is_none()
    });
    match (table, raised) {
        (_, Some(raised)) => Err(raised),
        (table, None) => table.map(drop).map_err(no_table),
    }
}

fn rows_of<'s>(to: Place<'s>, plan: &Plan, done: u64, progress: Option<Py<PyAny>>) -> Rows<'s> {
    Rows {
        to,
        done,
        runs: plan.runs(),
        progress,
        next: Instant::now(),
        signals: Signals::new(),
    }
}

fn run_into(
    plan: &Plan,
    points: impl IntoIterator<Item = Range<u64>, IntoIter: Send>,
    threads: Option<NonZero<usize>>,
    rows: &mut Rows<'_>,
) -> PyResult<()> {
    let threads = threads
        .or_else(|| available_parallelism().ok())
        .map_or(1, NonZero::get);
    let threads = plan.threads(threads);
    run_all(points, threads, rows, |points, stop, give| {
        totals(plan, points, stop, give)
    })
    .map_err(|Failed(error)| error)?;
    rows.report()
}

fn failed(error: StoreError) -> PyErr {
    match error {
        StoreError::Scene(error) => errors::scene(error, false),
        error @ (StoreError::Another { .. } | StoreError::Unreadable { .. }) => {
            PyValueError::new_err(format!(
                "{error}: name another folder with out, or replace it with force=True"
            ))
        }
        error => PyOSError::new_err(error.to_string()),
    }
}

fn no_table(error: TableError) -> PyErr {
    PyOSError::new_err(error.to_string())
}

//! Runs a scene without the GIL.

use crate::columns::{Events, Trace};
use crate::errors;
use crate::scene::Scene;
use crate::signals::Signals;
use crepitus_scene::trace::{EventRecord, SymptomEvent};
use crepitus_scene::{Observer, RunError, Summary, run as runner};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Collects rows and events.
struct Collector<const ROWS: bool> {
    trace: Option<Trace>,
    events: Events,
    every: u64,
    rows: u64,
    signals: Signals,
}

impl<const ROWS: bool> Observer for Collector<ROWS> {
    type Error = PyErr;
    const WANTS_ROWS: bool = ROWS;
    const NEEDS_STEPS: bool = ROWS;

    fn row(&mut self, values: &[f64]) -> PyResult<()> {
        if let Some(trace) = &mut self.trace
            && self.rows.is_multiple_of(self.every)
        {
            trace.row(values);
        }
        self.rows += 1;
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> PyResult<()> {
        self.events.event(event);
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> PyResult<()> {
        self.events.symptom(event);
        Ok(())
    }

    fn progress(&mut self, _: f64) -> PyResult<()> {
        self.signals.check()
    }
}

type Results<'py> = (Option<Bound<'py, PyDict>>, Bound<'py, PyDict>, String);

/// Simulates a scene; returns trace, events and summary (JSON).
#[pyfunction]
#[pyo3(signature = (scene, *, trace, trace_every, costs))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scene: &Scene,
    trace: bool,
    trace_every: u64,
    costs: bool,
) -> PyResult<Results<'py>> {
    if trace {
        run::<true>(py, scene, trace_every, costs)
    } else {
        run::<false>(py, scene, trace_every, costs)
    }
}

fn run<'py, const ROWS: bool>(
    py: Python<'py>,
    scene: &Scene,
    every: u64,
    costs: bool,
) -> PyResult<Results<'py>> {
    let scene = &scene.checked;
    let rows = (runner::rows(scene) - 1) / every + 1;
    let trace = ROWS
        .then(|| Trace::new(runner::columns(scene), rows))
        .transpose()?;
    let mut collector = Collector::<ROWS> {
        trace,
        events: Events::default(),
        every,
        rows: 0,
        signals: Signals::new(),
    };
    let summary = py.detach(|| -> PyResult<Summary> {
        let mut summary =
            crepitus_scene::run(scene, &mut collector).map_err(|error| failed(scene, error))?;
        summary.crepitus_commit = option_env!("CREPITUS_COMMIT");
        if costs {
            runner::measure_costs(scene, &mut summary);
        }
        Ok(summary)
    })?;
    let summary = serde_json::to_string(&summary).map_err(|e| errors::run(e.to_string()))?;
    let trace = collector.trace.map(|trace| trace.into_dict(py));
    Ok((trace.transpose()?, collector.events.into_dict(py)?, summary))
}

fn failed(scene: &crepitus_scene::Scene, error: RunError<PyErr>) -> PyErr {
    let file = scene.file.display();
    match error {
        RunError::Observer(error) => error,
        RunError::Settings(error) => errors::scene(
            crepitus_scene::SceneError {
                file: scene.file.clone(),
                origin: None,
                key: String::new(),
                message: error.to_string(),
            },
            false,
        ),
        // `RunError` is non-exhaustive.
        error => errors::run(format!("{file}: {error}")),
    }
}

//! Experiments with people: a session, in memory or in the folder of a study, and a study's results.

use crepitus_studies::experiment::finding::Finding;
use crepitus_studies::experiment::protocol::Known;
use crepitus_studies::experiment::session::Session as Trials;
use crepitus_studies::experiment::store::{Beginning, Store};
use crepitus_studies::experiment::table::severity;
use crepitus_studies::experiment::{
    Findings, Held, Protocol, Rating, Response, Row, StoreError, Trial,
};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A session: see `crepitus.Session`.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Session(Mutex<Kept>);

/// Destination of the answers.
enum Kept {
    /// Nowhere: of a simulated observer.
    InMemory(Box<Trials>),
    /// A study.
    InFiles(Box<Held>),
}

impl Kept {
    fn trials(&self) -> &Trials {
        match self {
            Self::InMemory(trials) => trials,
            Self::InFiles(held) => held.session(),
        }
    }
}

#[pymethods]
impl Session {
    /// A session in memory, of a protocol (JSON).
    #[staticmethod]
    fn in_memory(protocol: &str, seed: u64) -> PyResult<Self> {
        let protocol: Protocol = serde_json::from_str(protocol).map_err(invalid)?;
        protocol.check(Known::SHIPPED).map_err(invalid)?;
        let trials = Trials::new(protocol, seed);
        Ok(Self(Mutex::new(Kept::InMemory(Box::new(trials)))))
    }

    /// A session of a study, which goes on or begins; returns it, and whether it goes on.
    #[staticmethod]
    fn begin(
        folder: PathBuf,
        protocol: PathBuf,
        participant: &str,
        seed: Option<u64>,
        has_consented: bool,
        unix_s: u64,
    ) -> PyResult<(Self, bool)> {
        let beginning = Beginning {
            protocol: &protocol,
            participant,
            seed,
            has_consented,
            unix_s,
        };
        let store = Store::create(&folder).map_err(stored)?;
        let (held, goes_on) = store.begin(beginning, Known::SHIPPED).map_err(stored)?;
        Ok((Self(Mutex::new(Kept::InFiles(Box::new(held)))), goes_on))
    }

    /// The protocol (JSON).
    #[getter]
    fn protocol(&self) -> PyResult<String> {
        serde_json::to_string(self.lock().trials().protocol()).map_err(invalid)
    }

    /// Its begin (JSON); `None` in memory.
    #[getter]
    fn begun(&self) -> PyResult<Option<String>> {
        match &*self.lock() {
            Kept::InMemory(_) => Ok(None),
            Kept::InFiles(held) => serde_json::to_string(held.begun())
                .map(Some)
                .map_err(invalid),
        }
    }

    /// The current trial (JSON), with what whoever is blind must not see; `None` if the session is over.
    fn trial(&self) -> Option<String> {
        self.lock().trials().trial().map(|trial| shown(&trial))
    }

    /// Description of the current knee, which waits for its rating.
    #[getter]
    fn described(&self) -> Option<String> {
        self.lock().trials().described().map(str::to_owned)
    }

    /// Takes the choice of an alternative, from 1, at a time, s since 1970.
    fn choose(&self, answer: u8, unix_s: f64) -> PyResult<()> {
        self.answer(Response::Choice(answer), unix_s)
    }

    /// Takes a description.
    fn describe(&self, text: String, unix_s: f64) -> PyResult<()> {
        self.answer(Response::Description(text), unix_s)
    }

    /// Takes a rating.
    fn rate(
        &self,
        realism: Vec<u8>,
        severity_name: &str,
        disorder: &str,
        unix_s: f64,
    ) -> PyResult<()> {
        let severity = severity(severity_name).ok_or_else(|| {
            let message = "expected none, mild, moderate or severe";
            PyValueError::new_err(format!("severity {severity_name:?}: {message}"))
        })?;
        let finding = Finding::try_from(disorder.to_owned()).map_err(PyValueError::new_err)?;
        let rating = Rating {
            realism,
            severity,
            finding,
        };
        self.answer(Response::Rating(rating), unix_s)
    }

    /// Columns and rows of the answered trials.
    fn rows(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let kept = self.lock();
        let trials = kept.trials();
        let rows = trials.rows().iter().map(Row::record);
        (trials.header(), rows.collect())
    }
}

impl Session {
    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn answer(&self, response: Response, unix_s: f64) -> PyResult<()> {
        match &mut *self.lock() {
            Kept::InMemory(trials) => trials.answer(response, unix_s).map(drop).map_err(invalid),
            Kept::InFiles(held) => {
                let answered = held.answer(response, unix_s).map(drop);
                answered.map_err(|error| stored(StoreError::from(error)))
            }
        }
    }
}

/// Results of a study (JSON), and the table of all trials of each protocol (CSV).
#[pyfunction]
pub(crate) fn experiment_results(folder: PathBuf) -> PyResult<(String, Vec<String>)> {
    let sessions = Store::open(&folder).and_then(|store| store.sessions());
    let all = Findings::all(&sessions.map_err(stored)?, |name| Known::SHIPPED.find(name));
    let all = all.map_err(invalid)?;
    let json: Vec<_> = all.iter().map(Findings::to_json).collect();
    let tables = all.into_iter().map(|findings| findings.table).collect();
    Ok((Value::Array(json).to_string(), tables))
}

/// Pseudonyms of a study.
#[pyfunction]
pub(crate) fn experiment_participants(folder: PathBuf) -> PyResult<Vec<String>> {
    let store = Store::open(&folder);
    store.and_then(|store| store.participants()).map_err(stored)
}

/// Copies everything of a participant to a new folder.
#[pyfunction]
pub(crate) fn experiment_export(folder: PathBuf, participant: &str, to: PathBuf) -> PyResult<()> {
    let store = Store::open(&folder);
    store
        .and_then(|store| store.export(participant, &to))
        .map_err(stored)
}

/// Copies all sessions to a new folder, which is a study for others to read; returns their number.
#[pyfunction]
pub(crate) fn experiment_deposit(
    folder: PathBuf,
    to: PathBuf,
    with_descriptions: bool,
) -> PyResult<usize> {
    let store = Store::open(&folder);
    store
        .and_then(|store| store.deposit(&to, with_descriptions))
        .map_err(stored)
}

/// Removes everything of a participant; returns the number of sessions.
#[pyfunction]
pub(crate) fn experiment_delete(
    folder: PathBuf,
    participant: &str,
    force: bool,
) -> PyResult<usize> {
    let store = Store::open(&folder);
    store
        .and_then(|store| store.delete(participant, force))
        .map_err(stored)
}

fn shown(trial: &Trial) -> String {
    let intervals = trial.intervals.iter().map(|stimulus| {
        json!({
            "preset": stimulus.preset,
            "device": stimulus.device,
            "values": stimulus.values,
        })
    });
    json!({
        "number": trial.number,
        "of": trial.of,
        "intervals": intervals.collect::<Vec<_>>(),
    })
    .to_string()
}

fn invalid(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn stored(error: StoreError) -> PyErr {
    match error {
        StoreError::Write { .. } | StoreError::Read { .. } => PyOSError::new_err(error.to_string()),
        error => invalid(error),
    }
}

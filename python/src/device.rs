//! A device: requests, samples, recordings.

use crate::errors;
use crate::following::{failure, follow};
use crate::knee::knee;
use crate::received::{accounting_json, not_recorded, recorded, unsubscribed};
use crate::samples::Samples;
use crate::scene::Scene;
use crepitus_client::connection::{Connection, OpenError, device_text, parameters};
use crepitus_client::values::{full_name, parse_value, show_number};
use crepitus_client::{Client, Error, Transport};
use crepitus_protocol::State;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_recording::{Metadata, Recorder};
use crepitus_scene::Knee;
use crepitus_scene::Overrides;
use crepitus_scene::shipped;
use crepitus_scene::values::{with_preset, with_scene};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt};
use serde_json::{Map, Value};
use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Longest duration of one call, s: a day.
const MOST_S: f64 = 86_400.0;

/// A connection to a device. Requests of several threads wait for each other, but `stop`
/// ends what another thread does.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Device {
    client: Mutex<Option<Client<Connection>>>,
    /// Number of pending calls of `stop`.
    stops: AtomicU32,
    /// Stops so far: an arm that waited through one is refused.
    stopped: AtomicU64,
    stop: AtomicBool,
    /// Id of the process that opened it.
    process: u32,
}

#[pymethods]
impl Device {
    /// Opens a device: see `crepitus.Device`.
    #[new]
    #[pyo3(signature = (name, scene, *, real_time, program))]
    fn new(
        py: Python<'_>,
        name: Option<String>,
        scene: Option<Py<Scene>>,
        real_time: bool,
        program: &str,
    ) -> PyResult<Self> {
        let default = || {
            let name = Path::new("passive-examination");
            shipped::scene(name, &Overrides::default())
        };
        let scene = scene.map(|scene| scene.get().checked.clone());
        let client = py.detach(|| {
            let scene = || scene.map_or_else(default, Ok);
            let connection =
                Connection::open(name.as_deref(), program, scene).map_err(not_opened)?;
            let connection = if real_time {
                connection.in_real_time()
            } else {
                connection
            };
            Client::connect(connection).map_err(failure)
        })?;
        Ok(Self {
            client: Mutex::new(Some(client)),
            stops: AtomicU32::new(0),
            stopped: AtomicU64::new(0),
            stop: AtomicBool::new(false),
            process: process::id(),
        })
    }

    /// Disarms and closes the connection; closing again does nothing.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        if process::id() != self.process {
            return Ok(());
        }
        py.detach(|| {
            let Some(client) = self.lock().take() else {
                return Ok(());
            };
            if !client.is_connected() {
                return Ok(());
            }
            client.close().map(drop).map_err(failure)
        })
    }

    /// Returns whether the connection is closed.
    #[getter]
    fn closed(&self, py: Python<'_>) -> bool {
        py.detach(|| self.lock().is_none())
    }

    /// Returns port, identities, status, faults, counters and times of the tasks (JSON).
    fn info(&self, py: Python<'_>) -> PyResult<String> {
        self.request(py, |client| {
            let status = client.status()?;
            let counters = client.counters()?;
            let times = client.times()?;
            let (port, handshake) = (client.port(), client.handshake());
            let info = device_text::info_json(&port, handshake, &status, &counters, &times);
            Ok(info.to_string())
        })
    }

    /// Returns revision and values of the parameters (JSON).
    fn parameters(&self, py: Python<'_>) -> PyResult<(u32, String)> {
        let (revision, values) = self.request(py, Client::parameters)?;
        let values: Map<String, Value> = values
            .iter()
            .map(|(parameter, value)| (full_name(parameter), parameters::named(parameter, value)))
            .collect();
        Ok((revision.0, Value::Object(values).to_string()))
    }

    /// Sets parameters in one commit; returns the new revision.
    fn set_parameters(&self, py: Python<'_>, values: &Bound<'_, PyDict>) -> PyResult<u32> {
        let mut changes = Vec::new();
        for (name, value) in values {
            let name: String = name.extract()?;
            let (id, parameter) =
                parameters::find(&name).map_err(|e| PyValueError::new_err(e.to_string()))?;
            let text = if value.is_exact_instance_of::<PyBool>() {
                // `on` and `off`, where a choice has these names.
                if value.is_truthy()? { "on" } else { "off" }.to_owned()
            } else if let Ok(text) = value.extract::<String>() {
                text
            } else if value.is_instance_of::<PyInt>() || value.hasattr("__float__")? {
                show_number(value.extract()?)
            } else {
                value.repr()?.to_string()
            };
            let value = parse_value(parameter, &text)
                .map_err(|error| PyValueError::new_err(format!("{name} = {text}: {error}")))?;
            changes.push((id, value));
        }
        self.request(py, |client| client.set(&changes))
            .map(|revision| revision.0)
    }

    /// Applies the knee of a scene, or of a path or name of a preset or scene; returns the new
    /// revision.
    #[pyo3(signature = (what, *, scene, add))]
    fn apply(
        &self,
        py: Python<'_>,
        what: Option<PathBuf>,
        scene: Option<Py<Scene>>,
        add: bool,
    ) -> PyResult<u32> {
        let source = match (scene, what) {
            (Some(scene), _) => Knee::Scene(Box::new(scene.get().checked.clone())),
            (None, what) => knee(&what.unwrap_or_default())?,
        };
        self.work(py, |client| {
            let (base, now) = client.parameters().map_err(failure)?;
            let values = match &source {
                Knee::Preset(preset) => with_preset(&now, preset, add),
                Knee::Scene(_) if add => {
                    return Err(PyValueError::new_err(
                        "add=True needs a preset: a scene says which effects there are, and which not",
                    ));
                }
                Knee::Scene(scene) => with_scene(&now, scene)
                    .map_err(|error| PyValueError::new_err(error.to_string()))?,
            };
            client.commit(base, &values).map_err(failure)
        })
        .map(|revision| revision.0)
    }

    /// Sets some groups of parameters to their defaults; returns the new revision.
    fn reset(&self, py: Python<'_>, groups: Vec<String>) -> PyResult<u32> {
        if let Some(unknown) = groups
            .iter()
            .find(|g| !PARAMETERS.iter().any(|p| p.group == **g))
        {
            let mut known: Vec<_> = PARAMETERS.iter().map(|p| p.group).collect();
            known.dedup();
            return Err(PyValueError::new_err(format!(
                "unknown group of parameters {unknown:?}: expected one of {}",
                known.join(", ")
            )));
        }
        self.request(py, |client| {
            let (base, mut values) = client.parameters()?;
            for parameter in PARAMETERS
                .iter()
                .filter(|p| groups.iter().any(|g| g == p.group))
            {
                values.set(parameter.id, parameter.default());
            }
            client.commit(base, &values)
        })
        .map(|revision| revision.0)
    }

    /// Saves the parameters for the next start.
    fn save(&self, py: Python<'_>) -> PyResult<()> {
        self.request(py, Client::save)
    }

    /// Sets the angle's zero here: hold the leg straight.
    fn zero(&self, py: Python<'_>) -> PyResult<()> {
        self.request(py, Client::zero)
    }

    /// Tests the enable lines, then turns torque on.
    fn arm(&self, py: Python<'_>) -> PyResult<()> {
        let stopped = self.stopped.load(Ordering::SeqCst);
        self.work(py, |client| {
            if self.stopped.load(Ordering::SeqCst) != stopped {
                return Err(errors::device(
                    "the device was stopped while this waited for its turn: arm it again if you want torque"
                        .to_owned(),
                ));
            }
            client.arm().map_err(failure)
        })
    }

    /// Turns torque off.
    fn disarm(&self, py: Python<'_>) -> PyResult<()> {
        self.request(py, |client| {
            client.disarm()?;
            settle(client)
        })
    }

    /// Turns torque off at once, whichever program has armed the device; ends what another thread
    /// does with it.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.stopped.fetch_add(1, Ordering::SeqCst);
        self.stops.fetch_add(1, Ordering::Relaxed);
        self.stop.store(true, Ordering::Relaxed);
        let result = self.request(py, |client| {
            client.stop()?;
            settle(client)
        });
        if self.stops.fetch_sub(1, Ordering::Relaxed) == 1 {
            self.stop.store(false, Ordering::Relaxed);
        }
        result
    }

    /// Clears the faults.
    fn clear_fault(&self, py: Python<'_>) -> PyResult<()> {
        self.request(py, Client::clear_fault)
    }

    /// Returns whether this connection has armed the device, and it is still armed.
    #[getter]
    fn armed(&self, py: Python<'_>) -> PyResult<bool> {
        self.work(py, |client| Ok(client.is_armed()))
    }

    /// Lets time pass, and keeps an armed device armed.
    fn wait(&self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        let time = duration(seconds)?;
        self.work(py, |client| follow(client, time, &self.stop, |_, _| Ok(())))
    }

    /// Streams samples for a duration, s, every n-th of them; returns them with the accounting
    /// (JSON).
    fn stream<'py>(
        &self,
        py: Python<'py>,
        seconds: f64,
        every: u64,
    ) -> PyResult<(Bound<'py, PyDict>, String)> {
        let time = duration(seconds)?;
        let (samples, accounting) = self.work(py, |client| {
            let mut samples = Samples::default();
            let mut converter = crepitus_recording::Samples::default();
            let mut revision = None;
            client.subscribe().map_err(failure)?;
            let result = follow(client, time, &self.stop, |client, block| {
                if revision != Some(block.revision) {
                    let (now, values) = client.parameters().map_err(failure)?;
                    converter.set(&values);
                    revision = Some(now);
                }
                for row in converter.rows(block) {
                    if row.tick.is_multiple_of(every) {
                        samples.push(&row);
                    }
                }
                Ok(())
            });
            let accounting = client.accounting().map_or(Value::Null, accounting_json);
            unsubscribed(client, result)?;
            Ok((samples, accounting.to_string()))
        })?;
        Ok((samples.into_dict(py)?, accounting))
    }

    /// Records every sample for a duration, s; returns the accounting (JSON), or `None` if no
    /// sample came, and then there is no file.
    fn record(
        &self,
        py: Python<'_>,
        file: PathBuf,
        seconds: f64,
        title: &str,
    ) -> PyResult<Option<String>> {
        let time = duration(seconds)?;
        self.work(py, |client| {
            let handshake = client.handshake();
            let metadata = Metadata::new(title, &handshake.comms, handshake.drive.as_ref());
            let mut recorder = Recorder::create(&file, &metadata).map_err(not_recorded)?;
            let result = recorded(client, &mut recorder, time, &self.stop);
            let result = unsubscribed(client, result);
            if recorder.totals().received == 0 {
                drop(recorder);
                fs::remove_file(&file)?;
                return result.map(|()| None);
            }
            // What was recorded is kept, also after an error.
            let totals = recorder.finish().map_err(not_recorded)?;
            result?;
            let totals = serde_json::to_string(&totals);
            totals
                .map(Some)
                .map_err(|error| errors::device(error.to_string()))
        })
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let port = py.detach(|| self.lock().as_ref().map(Client::port));
        format!("<Device {}>", port.as_deref().unwrap_or("closed"))
    }
}

impl Device {
    /// Locks the client; callers must have released the GIL.
    fn lock(&self) -> MutexGuard<'_, Option<Client<Connection>>> {
        // A panic has ended a request; the lease then ends the torque.
        self.client.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs `work` with the client of an open device, without the GIL.
    fn work<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Client<Connection>) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        if process::id() != self.process {
            return Err(errors::device(
                "this device was opened before a fork: open it in the process that uses it"
                    .to_owned(),
            ));
        }
        py.detach(|| match &mut *self.lock() {
            Some(client) => work(client),
            None => Err(errors::device(
                "this device is closed: open it again".to_owned(),
            )),
        })
    }

    fn request<T: Send>(
        &self,
        py: Python<'_>,
        request: impl FnOnce(&mut Client<Connection>) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        self.work(py, |client| request(client).map_err(failure))
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        let client = self
            .client
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner);
        let Some(client) = client.take() else { return };
        if process::id() != self.process {
            // The other process still uses the port.
            std::mem::forget(client);
        } else if client.is_connected() && client.is_armed() {
            // Without an answer its lease ends the torque.
            let _ = client.close();
        }
    }
}

/// Waits until the drive reports that torque is off, which takes some milliseconds, so that the
/// next `info` has it.
fn settle(client: &mut Client<Connection>) -> Result<(), Error> {
    const TRIES: u32 = 20;
    for _ in 0..TRIES {
        if client.status()?.state != State::Armed {
            break;
        }
        client.transport_mut().wait(Duration::from_millis(5));
    }
    Ok(())
}

fn not_opened(error: OpenError) -> PyErr {
    match error {
        OpenError::Scene(error) => errors::scene(error, false),
        OpenError::None => errors::device(
            "no device is attached: plug one in, or use a simulated one with Device(\"sim\")"
                .to_owned(),
        ),
        OpenError::Several { ports } => errors::device(format!(
            "several devices are attached: choose one with Device(port): {}",
            ports.join(", ")
        )),
        OpenError::Emulated(_) if !cfg!(feature = "emulator") => errors::device(
            "this package was built without the emulator; build it with \
             `pip install ./python --config-settings=build-args=\"--features emulator\"`"
                .to_owned(),
        ),
        error => errors::device(error.to_string()),
    }
}

fn duration(seconds: f64) -> PyResult<Duration> {
    if (0.0..=MOST_S).contains(&seconds) {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err(PyValueError::new_err(format!(
            "seconds: expected a time from 0 to {MOST_S} s, got {seconds}"
        )))
    }
}

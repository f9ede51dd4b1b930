//! A device: requests, samples, recordings.

use crate::blocks::{self, Blocks, Received};
use crate::errors;
use crate::errors::failure;
use crate::following::follow;
use crate::knee::knee;
use crate::received;
use crate::scene::Scene;
use crate::timeline::Timeline;
use crate::turns::{Held, Shared, Turn};
use crepitus_client::connection::{Connection, OpenError, device_text, parameters};
use crepitus_client::values::{full_name, parse_value, show_number};
use crepitus_client::{Client, Error, Transport};
use crepitus_protocol::State;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_scene::Knee;
use crepitus_scene::Overrides;
use crepitus_scene::preset::{self, Preset};
use crepitus_scene::shipped;
use crepitus_scene::values::{with_named, with_preset, with_scene};
use crepitus_studies::experiment::finding::HEALTHY;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Longest duration of one call, s: a day.
const MOST_S: f64 = 86_400.0;

/// Shortest block of a stream: that of the device.
const SHORTEST_BLOCK: Duration = Duration::from_millis(1);

/// A connection to a device. Requests of several threads take turns, also while one of them streams.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Device(Arc<Shared>);

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
        py.detach(|| {
            let scene = || scene.map_or_else(default, Ok);
            let connection =
                Connection::open(name.as_deref(), program, scene).map_err(not_opened)?;
            let connection = if real_time {
                connection.in_real_time()
            } else {
                connection
            };
            let mut client = Client::connect(connection).map_err(failure)?;
            let tick = client.status().map_err(failure)?.tick;
            let held = Held {
                timeline: Timeline::new(tick, client.now()),
                client,
                expects_torque: false,
            };
            Ok(Self(Arc::new(Shared::new(held))))
        })
    }

    /// Disarms and closes the connection; closing again does nothing.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        if !self.0.is_ours() {
            return Ok(());
        }
        py.detach(|| {
            let Some(Held { client, .. }) = self.0.lock().take() else {
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
        py.detach(|| self.0.lock().is_none())
    }

    /// Unix time at which `t_s` was zero, s.
    #[getter]
    fn zero_unix_s(&self, py: Python<'_>) -> PyResult<f64> {
        self.0.work(py, |held| Ok(held.timeline.zero_unix_s))
    }

    /// Returns port, identities, status, faults, counters and times of the tasks (JSON).
    fn info(&self, py: Python<'_>) -> PyResult<String> {
        self.0.request(py, |client| {
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
        let (revision, values) = self.0.request(py, Client::parameters)?;
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
        self.0
            .request(py, |client| client.set(&changes))
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
        self.0.work(py, |Held { client, .. }| {
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

    /// Applies a preset, or a healthy knee, with some of its parameters, in one commit; returns the new revision.
    fn present(
        &self,
        py: Python<'_>,
        preset: &str,
        values: BTreeMap<String, f64>,
    ) -> PyResult<u32> {
        let preset = match preset::find(preset) {
            Some(preset) => preset.clone(),
            None if preset == HEALTHY => Preset::default(),
            None => match knee(Path::new(preset))? {
                Knee::Preset(preset) => *preset,
                Knee::Scene(_) => {
                    let message = format!("{preset}: expected a preset, got a scene");
                    return Err(PyValueError::new_err(message));
                }
            },
        };
        self.0
            .work(py, |Held { client, .. }| {
                let (base, now) = client.parameters().map_err(failure)?;
                let values = values.iter().map(|(name, value)| (name.as_str(), *value));
                let values = with_named(&now, &preset, values)
                    .map_err(|error| PyValueError::new_err(error.to_string()))?;
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
        self.0
            .request(py, |client| {
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
        self.0.request(py, Client::save)
    }

    /// Sets the angle's zero here: hold the leg straight.
    fn zero(&self, py: Python<'_>) -> PyResult<()> {
        self.0.request(py, Client::zero)
    }

    /// Tests the enable lines, then turns torque on.
    fn arm(&self, py: Python<'_>) -> PyResult<()> {
        let stops = self.0.stops();
        self.0.work(py, |held| {
            if self.0.stops() != stops {
                return Err(errors::device(
                    "the device was stopped while this waited for its turn: arm it again if you want torque"
                        .to_owned(),
                ));
            }
            held.client.arm().map_err(failure)?;
            held.expects_torque = true;
            Ok(())
        })
    }

    /// Turns torque off.
    fn disarm(&self, py: Python<'_>) -> PyResult<()> {
        self.0.work(py, |held| {
            held.expects_torque = false;
            held.client.disarm().map_err(failure)?;
            settle(&mut held.client).map_err(failure)
        })
    }

    /// Turns torque off at once, whichever program has armed the device; ends what another thread
    /// does with it.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.0.note_stop();
        self.0.work(py, |held| {
            held.expects_torque = false;
            held.client.stop().map_err(failure)?;
            settle(&mut held.client).map_err(failure)
        })
    }

    /// Clears the faults.
    fn clear_fault(&self, py: Python<'_>) -> PyResult<()> {
        self.0.request(py, Client::clear_fault)
    }

    /// Returns whether this connection has armed the device, and it is still armed.
    #[getter]
    fn armed(&self, py: Python<'_>) -> PyResult<bool> {
        self.0.request(py, |client| {
            if client.is_armed() {
                client.status()?;
            }
            Ok(client.is_armed())
        })
    }

    /// Lets time pass, and keeps an armed device armed.
    fn wait(&self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        let time = duration(seconds)?;
        py.detach(|| follow(&Turn::take(&self.0)?, time, |_, _| Ok(true)))
    }

    /// Streams samples for a duration, s, every n-th of them.
    fn stream<'py>(&self, py: Python<'py>, seconds: f64, every: u64) -> PyResult<Received<'py>> {
        blocks::stream(py, &self.0, duration(seconds)?, every)
    }

    /// Subscribes to samples in blocks of a duration, s, every n-th of them, for a while or without end.
    fn blocks(
        &self,
        py: Python<'_>,
        block_s: f64,
        seconds: Option<f64>,
        every: u64,
    ) -> PyResult<Blocks> {
        let left = seconds.map(duration).transpose()?;
        let block = duration(block_s)?;
        if block < SHORTEST_BLOCK {
            return Err(PyValueError::new_err(format!(
                "block_s: expected at least {} s, got {block_s}",
                SHORTEST_BLOCK.as_secs_f64()
            )));
        }
        Blocks::begin(py, &self.0, block, left, every)
    }

    /// Marks this moment in the samples; returns its time, s.
    fn mark(&self, py: Python<'_>, text: String) -> PyResult<f64> {
        self.0.work(py, |held| {
            let tick = held.client.status().map_err(failure)?.tick;
            Ok(held.timeline.mark(tick, text))
        })
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
        py.detach(|| received::record(&Turn::take(&self.0)?, &file, title, time))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let port = py.detach(|| self.0.lock().as_ref().map(|held| held.client.port()));
        format!("<Device {}>", port.as_deref().unwrap_or("closed"))
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

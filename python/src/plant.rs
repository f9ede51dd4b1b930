//! Plants that a Python program steps.

use crate::columns::Trace;
use crate::errors;
use crate::rung::finite;
use crate::scene::Scene;
use crate::signals::Signals;
use crepitus_scene::run::{Diverged, Holder, MOST_TORQUE_NM, SteppedPlant};
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

/// Ticks of all plants between two checks of signals.
const CHECK_TICKS: u64 = 1_000;

/// Plants of one scene, side by side.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Plant {
    plants: Mutex<Vec<SteppedPlant>>,
    count: usize,
    /// Whether a torque of the caller moves the leg.
    #[pyo3(get)]
    takes_torque: bool,
}

#[pymethods]
impl Plant {
    /// Creates `count` plants of a scene; a torque of the caller moves the leg, or the scene's hand does.
    #[new]
    #[pyo3(signature = (scene, count, *, takes_torque))]
    fn new(scene: &Scene, count: usize, takes_torque: bool) -> PyResult<Self> {
        let holder = if takes_torque {
            Holder::Torque
        } else {
            Holder::Scene
        };
        let first = SteppedPlant::new(&Arc::new(scene.checked.clone()), holder)
            .map_err(|error| scene.refused("effects", error.to_string()))?;
        Ok(Self {
            plants: Mutex::new(vec![first; count]),
            count,
            takes_torque,
        })
    }

    fn __len__(&self) -> usize {
        self.count
    }

    /// Makes `ticks` ticks with these torques, N·m, a number for each plant; returns the states after them.
    fn step<'py>(
        &self,
        py: Python<'py>,
        hand_nm: Option<PyReadonlyArray1<'py, f64>>,
        motor_nm: Option<PyReadonlyArray1<'py, f64>>,
        ticks: u64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let hand_nm = match (self.takes_torque, hand_nm) {
            (true, Some(hand_nm)) => torques("hand_torque_nm", &hand_nm, self.count)?,
            (true, None) => {
                return Err(PyValueError::new_err(
                    "hand_torque_nm: expected the torque of the hand, N·m; pass 0.0 for a leg that nobody holds, or make \
                     the plant with hand=\"scene\"",
                ));
            }
            (false, Some(_)) => {
                return Err(PyValueError::new_err(
                    "hand_torque_nm: the scene's own hand or motion moves the leg; make the plant with hand=\"torque\" to \
                     push it",
                ));
            }
            (false, None) => vec![0.0; self.count],
        };
        let motor_nm = motor_nm
            .map(|nm| torques("motor_torque_nm", &nm, self.count))
            .transpose()?;
        let mut plants = self.lock()?;
        let left = plants.iter().filter_map(SteppedPlant::ticks_left).min();
        if let Some(left) = left.filter(|left| *left < ticks) {
            return Err(PyValueError::new_err(format!(
                "steps: expected at most {left}, got {ticks}: the scene's motion ends there; raise its duration_s, or make \
                 the plant with hand=\"torque\""
            )));
        }
        let all: &mut Vec<SteppedPlant> = &mut plants;
        py.detach(|| {
            let mut signals = Signals::new();
            let mut since_check = 0;
            for (n, plant) in all.iter_mut().enumerate() {
                let motor_nm = motor_nm.as_ref().map(|nm| nm[n]);
                for _ in 0..ticks {
                    plant.tick(hand_nm[n], motor_nm);
                    since_check += 1;
                    if since_check >= CHECK_TICKS {
                        since_check = 0;
                        plant.check().map_err(|error| diverged(n, error))?;
                        signals.check()?;
                    }
                }
                plant.check().map_err(|error| diverged(n, error))?;
            }
            Ok::<_, PyErr>(())
        })?;
        states(py, &plants)
    }

    /// States of all plants.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        states(py, &self.lock()?)
    }

    /// Time since the start of each, s.
    #[getter]
    fn time_s(&self) -> PyResult<f64> {
        Ok(self.lock()?.first().map_or(0.0, SteppedPlant::time_s))
    }

    /// Returns plants with the same states.
    fn copy(&self) -> PyResult<Self> {
        Ok(Self {
            plants: Mutex::new(self.lock()?.clone()),
            count: self.count,
            takes_torque: self.takes_torque,
        })
    }

    /// Goes back to the states of a copy of these plants.
    fn restore(&self, to: &Self) -> PyResult<()> {
        let to = to.lock()?.clone();
        *self.lock()? = to;
        Ok(())
    }
}

impl Plant {
    /// Locks the plants; fails if another thread steps them, since waiting would hold the GIL that the other
    /// may need.
    fn lock(&self) -> PyResult<MutexGuard<'_, Vec<SteppedPlant>>> {
        match self.plants.try_lock() {
            Ok(plants) => Ok(plants),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread is stepping this plant: give each thread its own copy",
            )),
            Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(
                "a step of this plant has failed: make another one",
            )),
        }
    }
}

/// Checked torques, one for each plant.
fn torques(name: &str, array: &PyReadonlyArray1<'_, f64>, count: usize) -> PyResult<Vec<f64>> {
    if array.len() != count {
        return Err(PyValueError::new_err(format!(
            "{name}: expected a number or {count} of them, got {}",
            array.len()
        )));
    }
    let all: Vec<f64> = array.as_array().iter().copied().collect();
    for (n, nm) in all.iter().enumerate() {
        finite(&format!("{name}[{n}]"), *nm)?;
        if nm.abs() > MOST_TORQUE_NM {
            return Err(PyValueError::new_err(format!(
                "{name}[{n}]: expected at most {MOST_TORQUE_NM} N·m either way, got {nm}: limit it, and check its unit"
            )));
        }
    }
    Ok(all)
}

fn states<'py>(py: Python<'py>, plants: &[SteppedPlant]) -> PyResult<Bound<'py, PyDict>> {
    let columns = plants
        .first()
        .map(SteppedPlant::columns)
        .unwrap_or_default();
    let mut trace = Trace::new(columns, plants.len() as u64)?;
    let mut row = Vec::new();
    for plant in plants {
        plant.row(&mut row);
        trace.row(&row);
    }
    trace.into_dict(py)
}

fn diverged(plant: usize, error: Diverged) -> PyErr {
    errors::run(format!(
        "plant {plant}: {error}; restore a snapshot to go on from before"
    ))
}

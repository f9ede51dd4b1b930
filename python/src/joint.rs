//! Joint that a Python program steps.

use crate::scene::Scene;
use crate::signals::Signals;
use crepitus_model::{Event, EventKind, ShaftStep, StickSlip};
use crepitus_scene::any_joint::AnyJoint;
use crepitus_scene::scene::{Precision, SolverChoice};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Steps between two checks for Ctrl-C.
const UNWATCHED_STEPS: usize = 100_000;

/// Stick-slip object alone, for a simulation loop in Python.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Joint(Mutex<Inner>);

struct Inner {
    joint: Rung,
    /// Shaft velocity at the end of the last step, rad/s.
    omega_rad_s: f64,
    events: Counts,
}

#[derive(Clone, Copy, Default)]
struct Counts {
    breaks: u64,
    sticks: u64,
    reverses: u64,
}

/// Joint in either precision; inputs and outputs are f64.
enum Rung {
    Single(AnyJoint<f32>),
    Double(AnyJoint<f64>),
}

#[pymethods]
impl Joint {
    /// Creates the joint of a scene, at a shaft that moves with `omega_rad_s`, rad/s.
    #[new]
    fn new(scene: &Scene, omega_rad_s: f64) -> PyResult<Self> {
        let Some(crepitus) = &scene.checked.crepitus else {
            let message = "the scene has no joint".to_owned();
            return Err(scene.refused("effects.crepitus", message));
        };
        let SolverChoice::Ladder {
            solver,
            step_s,
            precision,
        } = scene.checked.solver
        else {
            let message = "\"reference\" has no step: choose another solver".to_owned();
            return Err(scene.refused("solver.kind", message));
        };
        finite("omega_rad_s", omega_rad_s)?;
        let settings = &crepitus.settings;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the precision that was asked for"
        )]
        let joint = match precision {
            Precision::F32 => {
                AnyJoint::new(settings, solver, step_s, omega_rad_s as f32).map(Rung::Single)
            }
            Precision::F64 => {
                AnyJoint::new(settings, solver, step_s, omega_rad_s).map(Rung::Double)
            }
        };
        let joint = joint.map_err(|error| scene.refused("solver", error.to_string()))?;
        Ok(Self(Mutex::new(Inner {
            joint,
            omega_rad_s,
            events: Counts::default(),
        })))
    }

    /// Advances by one step, in which the shaft turns by `dphi_rad` and has `omega_rad_s` at its
    /// end. Returns the torque, N·m.
    fn step(&self, dphi_rad: f64, omega_rad_s: f64) -> PyResult<f64> {
        finite("dphi_rad", dphi_rad)?;
        finite("omega_rad_s", omega_rad_s)?;
        let mut inner = self.lock()?;
        inner.step(dphi_rad, omega_rad_s);
        Ok(inner.joint.torque_nm())
    }

    /// Advances by many steps; returns the state after each as arrays.
    fn steps<'py>(
        &self,
        py: Python<'py>,
        dphi_rad: PyReadonlyArray1<'py, f64>,
        omega_rad_s: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (turns, speeds) = (
            numbers("dphi_rad", &dphi_rad)?,
            numbers("omega_rad_s", &omega_rad_s)?,
        );
        if turns.len() != speeds.len() {
            return Err(PyValueError::new_err(format!(
                "dphi_rad and omega_rad_s: expected the same length, got {} and {}",
                turns.len(),
                speeds.len()
            )));
        }
        let mut states = States::of(turns.len());
        let mut inner = self.lock()?;
        let work = &mut *inner;
        py.detach(|| {
            let mut signals = Signals::new();
            let chunks = turns
                .chunks(UNWATCHED_STEPS)
                .zip(speeds.chunks(UNWATCHED_STEPS));
            for (turns, speeds) in chunks {
                for (dphi_rad, omega_rad_s) in turns.iter().zip(speeds) {
                    work.step(*dphi_rad, *omega_rad_s);
                    states.push(&work.joint);
                }
                signals.check()?;
            }
            Ok::<_, PyErr>(())
        })?;
        states.into_dict(py)
    }

    /// Puts the object in stick where the shaft is, with this torque (N·m) and speed of
    /// the shaft (rad/s).
    #[pyo3(signature = (torque_nm=0.0, omega_rad_s=0.0))]
    fn restart(&self, torque_nm: f64, omega_rad_s: f64) -> PyResult<()> {
        finite("torque_nm", torque_nm)?;
        finite("omega_rad_s", omega_rad_s)?;
        let mut inner = self.lock()?;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the precision that was asked for"
        )]
        match &mut inner.joint {
            Rung::Single(joint) => joint.restart(torque_nm as f32, omega_rad_s as f32),
            Rung::Double(joint) => joint.restart(torque_nm, omega_rad_s),
        }
        inner.omega_rad_s = omega_rad_s;
        Ok(())
    }

    /// Torque, N·m.
    #[getter]
    fn torque_nm(&self) -> PyResult<f64> {
        Ok(self.lock()?.joint.torque_nm())
    }

    /// Phase: 0 in stick, -1 or +1 in slip.
    #[getter]
    fn phase(&self) -> PyResult<i8> {
        Ok(self.lock()?.joint.phase())
    }

    /// Angle of the object, rad.
    #[getter]
    fn theta_rad(&self) -> PyResult<f64> {
        Ok(self.lock()?.joint.theta_rad())
    }

    /// Velocity of the object, rad/s.
    #[getter]
    fn theta_dot_rad_s(&self) -> PyResult<f64> {
        Ok(self.lock()?.joint.theta_dot_rad_s())
    }

    /// Events since the joint was made: break, stick, reverse.
    #[getter]
    fn events(&self) -> PyResult<(u64, u64, u64)> {
        let Counts {
            breaks,
            sticks,
            reverses,
        } = self.lock()?.events;
        Ok((breaks, sticks, reverses))
    }
}

impl Joint {
    /// Locks the joint; fails if another thread uses it, since waiting would hold the GIL that the
    /// other may need.
    fn lock(&self) -> PyResult<MutexGuard<'_, Inner>> {
        match self.0.try_lock() {
            Ok(inner) => Ok(inner),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread is stepping this joint: give each thread its own",
            )),
            Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(
                "a step of this joint has failed: make another one",
            )),
        }
    }
}

impl Inner {
    fn step(&mut self, dphi_rad: f64, omega_rad_s: f64) {
        let from = self.omega_rad_s;
        self.joint
            .step(dphi_rad, from, omega_rad_s, &mut self.events);
        self.omega_rad_s = omega_rad_s;
    }
}

impl Counts {
    fn count(&mut self, kind: EventKind) {
        match kind {
            EventKind::Break => self.breaks += 1,
            EventKind::Stick => self.sticks += 1,
            EventKind::Reverse => self.reverses += 1,
        }
    }
}

impl Rung {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the precision that was asked for"
    )]
    fn step(&mut self, dphi_rad: f64, from_rad_s: f64, to_rad_s: f64, events: &mut Counts) {
        match self {
            Self::Single(joint) => joint.step(
                &ShaftStep {
                    delta_phi_rad: dphi_rad as f32,
                    omega_start_rad_s: from_rad_s as f32,
                    omega_end_rad_s: to_rad_s as f32,
                },
                |event: Event<f32>| events.count(event.kind),
            ),
            Self::Double(joint) => joint.step(
                &ShaftStep {
                    delta_phi_rad: dphi_rad,
                    omega_start_rad_s: from_rad_s,
                    omega_end_rad_s: to_rad_s,
                },
                |event: Event<f64>| events.count(event.kind),
            ),
        }
    }

    fn torque_nm(&self) -> f64 {
        match self {
            Self::Single(joint) => joint.torque_nm().into(),
            Self::Double(joint) => joint.torque_nm(),
        }
    }

    fn phase(&self) -> i8 {
        match self {
            Self::Single(joint) => joint.phase().sign(),
            Self::Double(joint) => joint.phase().sign(),
        }
    }

    fn theta_rad(&self) -> f64 {
        match self {
            Self::Single(joint) => joint.theta_rad().into(),
            Self::Double(joint) => joint.theta_rad(),
        }
    }

    fn theta_dot_rad_s(&self) -> f64 {
        match self {
            Self::Single(joint) => joint.theta_dot_rad_s().into(),
            Self::Double(joint) => joint.theta_dot_rad_s(),
        }
    }
}

/// States after each step, by column.
struct States {
    torque_nm: Vec<f64>,
    phase: Vec<i8>,
    theta_rad: Vec<f64>,
    theta_dot_rad_s: Vec<f64>,
}

impl States {
    fn of(count: usize) -> Self {
        Self {
            torque_nm: Vec::with_capacity(count),
            phase: Vec::with_capacity(count),
            theta_rad: Vec::with_capacity(count),
            theta_dot_rad_s: Vec::with_capacity(count),
        }
    }

    fn push(&mut self, joint: &Rung) {
        self.torque_nm.push(joint.torque_nm());
        self.phase.push(joint.phase());
        self.theta_rad.push(joint.theta_rad());
        self.theta_dot_rad_s.push(joint.theta_dot_rad_s());
    }

    fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("torque_nm", self.torque_nm.into_pyarray(py))?;
        dict.set_item("phase", self.phase.into_pyarray(py))?;
        dict.set_item("theta_rad", self.theta_rad.into_pyarray(py))?;
        dict.set_item("theta_dot_rad_s", self.theta_dot_rad_s.into_pyarray(py))?;
        Ok(dict)
    }
}

fn finite(name: &str, x: f64) -> PyResult<()> {
    if x.is_finite() {
        Ok(())
    } else {
        Err(PyValueError::new_err(format!(
            "{name}: expected a finite number, got {x}"
        )))
    }
}

/// Returns the numbers of an array; rejects it if one is not finite, before any step is done.
fn numbers(name: &str, array: &PyReadonlyArray1<'_, f64>) -> PyResult<Vec<f64>> {
    let numbers: Vec<f64> = array.as_array().iter().copied().collect();
    match numbers.iter().position(|x| !x.is_finite()) {
        Some(n) => finite(&format!("{name}[{n}]"), numbers[n]).map(|()| numbers),
        None => Ok(numbers),
    }
}

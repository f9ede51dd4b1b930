//! Joint that a Python program steps.

use crate::rung::{Rung, Wanted, finite};
use crate::scene::Scene;
use numpy::PyReadonlyArrayDyn;
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Stick-slip object alone, for a simulation loop in Python.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Joint(Mutex<Rung>);

#[pymethods]
impl Joint {
    /// Creates the joint of a scene, at a shaft that moves with `omega_rad_s`, rad/s.
    #[new]
    fn new(scene: &Scene, omega_rad_s: f64) -> PyResult<Self> {
        finite("omega_rad_s", omega_rad_s)?;
        Rung::new(scene, &[omega_rad_s], &[]).map(|rung| Self(Mutex::new(rung)))
    }

    /// Advances by one step, in which the shaft turns by `dphi_rad` and has `omega_rad_s` at its
    /// end. Returns the torque, N·m.
    fn step(&self, dphi_rad: f64, omega_rad_s: f64) -> PyResult<f64> {
        finite("dphi_rad", dphi_rad)?;
        finite("omega_rad_s", omega_rad_s)?;
        let mut rung = lock(&self.0)?;
        rung.step(&[dphi_rad], &[omega_rad_s], false)?;
        Ok(rung.torque_nm())
    }

    /// Advances by many steps; returns the state after each as arrays.
    fn steps<'py>(
        &self,
        py: Python<'py>,
        dphi_rad: PyReadonlyArrayDyn<'py, f64>,
        omega_rad_s: PyReadonlyArrayDyn<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        if dphi_rad.len() != omega_rad_s.len() {
            return Err(PyValueError::new_err(format!(
                "dphi_rad and omega_rad_s: expected the same length, got {} and {}",
                dphi_rad.len(),
                omega_rad_s.len()
            )));
        }
        let wanted = Wanted {
            motion: true,
            double: true,
            threads: 1,
        };
        lock(&self.0)?.steps(py, (&dphi_rad, &omega_rad_s), false, wanted)
    }

    /// Puts the object in stick where the shaft is, with this torque (N·m) and speed of
    /// the shaft (rad/s).
    #[pyo3(signature = (torque_nm=0.0, omega_rad_s=0.0))]
    fn restart(&self, torque_nm: f64, omega_rad_s: f64) -> PyResult<()> {
        finite("torque_nm", torque_nm)?;
        finite("omega_rad_s", omega_rad_s)?;
        lock(&self.0)?.restart(0, torque_nm, omega_rad_s);
        Ok(())
    }

    /// Returns a joint with the same state.
    fn copy(&self) -> PyResult<Self> {
        Ok(Self(Mutex::new(lock(&self.0)?.clone())))
    }

    /// Torque, N·m.
    #[getter]
    fn torque_nm(&self) -> PyResult<f64> {
        Ok(lock(&self.0)?.torque_nm())
    }

    /// Phase: 0 in stick, -1 or +1 in slip.
    #[getter]
    fn phase(&self) -> PyResult<i8> {
        Ok(lock(&self.0)?.phases().first().copied().unwrap_or(0))
    }

    /// Angle of the object, rad.
    #[getter]
    fn theta_rad(&self) -> PyResult<f64> {
        Ok(lock(&self.0)?.motion().0)
    }

    /// Velocity of the object, rad/s.
    #[getter]
    fn theta_dot_rad_s(&self) -> PyResult<f64> {
        Ok(lock(&self.0)?.motion().1)
    }

    /// Events since the joint was made: break, stick, reverse.
    #[getter]
    fn events(&self) -> PyResult<(u64, u64, u64)> {
        let counts = lock(&self.0)?.counts();
        let counts = counts.first().copied().unwrap_or_default();
        Ok((counts.breaks, counts.sticks, counts.reverses))
    }
}

/// Locks joints; fails if another thread uses them, since waiting would hold the GIL that the
/// other may need.
pub(crate) fn lock(rung: &Mutex<Rung>) -> PyResult<MutexGuard<'_, Rung>> {
    match rung.try_lock() {
        Ok(inner) => Ok(inner),
        Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
            "another thread is stepping this joint: give each thread its own",
        )),
        Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(
            "a step of this joint has failed: make another one",
        )),
    }
}

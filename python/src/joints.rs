//! Many joints that a Python program steps at once.

use crate::joint::lock;
use crate::rung::{Rung, StepLimits, Wanted, finite, finite_numbers};
use crate::scene::Scene;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;

/// Joints that differ in parameters, stepped together.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Joints {
    rung: Mutex<Rung>,
    limits: StepLimits,
}

#[pymethods]
impl Joints {
    /// Creates joints of a scene at shafts that move with `omega_rad_s`, rad/s; `parameters` has numbers for
    /// each of them.
    #[new]
    fn new(
        scene: &Scene,
        omega_rad_s: PyReadonlyArrayDyn<'_, f64>,
        parameters: Vec<(String, PyReadonlyArrayDyn<'_, f64>)>,
    ) -> PyResult<Self> {
        let limits = StepLimits::of(scene);
        let omegas = limits.speeds(&omega_rad_s)?;
        let mut values = Vec::new();
        for (name, array) in parameters {
            if array.len() != omegas.len() {
                return Err(PyValueError::new_err(format!(
                    "{name}: expected {} numbers, got {}",
                    omegas.len(),
                    array.len()
                )));
            }
            let of_each = finite_numbers(&name, &array)?;
            values.push((name, of_each));
        }
        let rung = Mutex::new(Rung::new(scene, &omegas, &values)?);
        Ok(Self { rung, limits })
    }

    fn __len__(&self) -> PyResult<usize> {
        Ok(lock(&self.rung)?.len())
    }

    /// Advances all joints by one step, on one motion or (`of_each`) each on its own; returns the torques, N·m.
    fn step<'py>(
        &self,
        py: Python<'py>,
        dphi_rad: PyReadonlyArrayDyn<'py, f64>,
        omega_rad_s: PyReadonlyArrayDyn<'py, f64>,
        of_each: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (turns, speeds) = self.limits.motions(&dphi_rad, &omega_rad_s)?;
        let mut rung = lock(&self.rung)?;
        rung.step(&turns, &speeds, of_each)?;
        Ok(rung.torques_nm().into_pyarray(py))
    }

    /// Advances all joints by many steps, joint by joint; returns arrays of a row for each joint.
    fn steps<'py>(
        &self,
        py: Python<'py>,
        dphi_rad: PyReadonlyArrayDyn<'py, f64>,
        omega_rad_s: PyReadonlyArrayDyn<'py, f64>,
        of_each: bool,
        motion: bool,
        threads: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wanted = Wanted {
            motion,
            double: false,
            threads,
        };
        let (turns, speeds) = self.limits.motions(&dphi_rad, &omega_rad_s)?;
        lock(&self.rung)?.steps(py, (&turns, &speeds), of_each, wanted, |_| ())
    }

    /// Puts a joint in stick where its shaft is, with this torque (N·m) and speed (rad/s).
    fn restart(&self, joint: usize, torque_nm: f64, omega_rad_s: f64) -> PyResult<()> {
        finite("torque_nm", torque_nm)?;
        self.limits.speed("omega_rad_s", omega_rad_s)?;
        lock(&self.rung)?.restart(joint, torque_nm, omega_rad_s);
        Ok(())
    }

    /// Returns joints with the same states.
    fn copy(&self) -> PyResult<Self> {
        Ok(Self {
            rung: Mutex::new(lock(&self.rung)?.clone()),
            limits: self.limits,
        })
    }

    /// Torques, N·m.
    #[getter]
    fn torque_nm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(lock(&self.rung)?.torques_nm().into_pyarray(py))
    }

    /// Phases: 0 in stick, -1 or +1 in slip.
    #[getter]
    fn phase<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        Ok(lock(&self.rung)?.phases().to_vec().into_pyarray(py))
    }

    /// Angles of the objects, rad.
    #[getter]
    fn theta_rad<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(lock(&self.rung)?.motions().0.into_pyarray(py))
    }

    /// Velocities of the objects, rad/s.
    #[getter]
    fn theta_dot_rad_s<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(lock(&self.rung)?.motions().1.into_pyarray(py))
    }

    /// Events of each since it was made: breaks, sticks, reverses.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<u64>>; 3]> {
        let counts = lock(&self.rung)?.counts();
        let breaks: Vec<u64> = counts.iter().map(|of| of.breaks).collect();
        let sticks: Vec<u64> = counts.iter().map(|of| of.sticks).collect();
        let reverses: Vec<u64> = counts.iter().map(|of| of.reverses).collect();
        Ok([breaks, sticks, reverses].map(|of| of.into_pyarray(py)))
    }
}

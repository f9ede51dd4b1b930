//! Joint that a Python program steps.

use crate::rung::{Rung, StepLimits, Wanted, finite};
use crate::scene::Scene;
use crepitus_ladder::joints::Passivity;
use crepitus_model::{Settings, Validated};
use numpy::PyReadonlyArrayDyn;
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Stick-slip object alone, for a simulation loop in Python.
#[pyclass(frozen, module = "crepitus._crepitus")]
pub(crate) struct Joint {
    alone: Mutex<Alone>,
    settings: Validated<Settings>,
    limits: StepLimits,
}

/// A joint with the account of its energy.
#[derive(Clone)]
struct Alone {
    rung: Rung,
    account: EnergyAccount,
}

/// Energy that a shaft gets back, with the torque of each step held over the next one.
#[derive(Clone, Copy)]
struct EnergyAccount {
    torque_nm: f64,
    put_in_j: f64,
    /// The most that was put in so far, J.
    most_j: f64,
    /// The most that came back over any stretch, J.
    returned_j: f64,
}

impl EnergyAccount {
    fn new(torque_nm: f64) -> Self {
        Self {
            torque_nm,
            put_in_j: 0.0,
            most_j: 0.0,
            returned_j: 0.0,
        }
    }

    /// A step in which the shaft turned by this angle, rad, and after which the joint has this torque, N·m.
    #[inline]
    fn step(&mut self, turned_rad: f64, torque_nm: f64) {
        self.put_in_j += self.torque_nm * turned_rad;
        self.most_j = self.most_j.max(self.put_in_j);
        self.returned_j = self.returned_j.max(self.most_j - self.put_in_j);
        self.torque_nm = torque_nm;
    }
}

#[pymethods]
impl Joint {
    /// Creates the joint of a scene, at a shaft that moves with `omega_rad_s`, rad/s.
    #[new]
    fn new(scene: &Scene, omega_rad_s: f64) -> PyResult<Self> {
        let limits = StepLimits::of(scene);
        limits.speed("omega_rad_s", omega_rad_s)?;
        let rung = Rung::new(scene, &[omega_rad_s], &[])?;
        let Some(crepitus) = &scene.checked.crepitus else {
            return Err(scene.refused("effects.crepitus", "the scene has no joint".to_owned()));
        };
        let account = EnergyAccount::new(rung.torque_nm());
        Ok(Self {
            alone: Mutex::new(Alone { rung, account }),
            settings: crepitus.settings,
            limits,
        })
    }

    /// Advances by one step, in which the shaft turns by `dphi_rad` and has `omega_rad_s` at its
    /// end. Returns the torque, N·m.
    fn step(&self, dphi_rad: f64, omega_rad_s: f64) -> PyResult<f64> {
        self.limits.turn("dphi_rad", dphi_rad)?;
        self.limits.speed("omega_rad_s", omega_rad_s)?;
        let mut alone = self.lock()?;
        alone.rung.step(&[dphi_rad], &[omega_rad_s], false)?;
        let torque_nm = alone.rung.torque_nm();
        alone.account.step(dphi_rad, torque_nm);
        Ok(torque_nm)
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
        let (turns_rad, speeds_rad_s) = self.limits.motions(&dphi_rad, &omega_rad_s)?;
        let mut alone = self.lock()?;
        let Alone { rung, account } = &mut *alone;
        let motion = (&turns_rad[..], &speeds_rad_s[..]);
        rung.steps(py, motion, false, wanted, |torques_nm| {
            for (turned_rad, torque_nm) in turns_rad.iter().zip(torques_nm) {
                account.step(*turned_rad, torque_nm);
            }
        })
    }

    /// Puts the object in stick where the shaft is, with this torque (N·m) and speed of
    /// the shaft (rad/s).
    #[pyo3(signature = (torque_nm=0.0, omega_rad_s=0.0))]
    fn restart(&self, torque_nm: f64, omega_rad_s: f64) -> PyResult<()> {
        finite("torque_nm", torque_nm)?;
        self.limits.speed("omega_rad_s", omega_rad_s)?;
        let mut alone = self.lock()?;
        alone.rung.restart(0, torque_nm, omega_rad_s);
        alone.account = EnergyAccount::new(alone.rung.torque_nm());
        Ok(())
    }

    /// Returns a joint with the same state.
    fn copy(&self) -> PyResult<Self> {
        Ok(Self {
            alone: Mutex::new(self.lock()?.clone()),
            settings: self.settings,
            limits: self.limits,
        })
    }

    /// Torque, N·m.
    #[getter]
    fn torque_nm(&self) -> PyResult<f64> {
        Ok(self.lock()?.rung.torque_nm())
    }

    /// Phase: 0 in stick, -1 or +1 in slip.
    #[getter]
    fn phase(&self) -> PyResult<i8> {
        let alone = self.lock()?;
        Ok(alone.rung.phases().first().copied().unwrap_or(0))
    }

    /// Angle of the object, rad.
    #[getter]
    fn theta_rad(&self) -> PyResult<f64> {
        Ok(self.lock()?.rung.motion().0)
    }

    /// Velocity of the object, rad/s.
    #[getter]
    fn theta_dot_rad_s(&self) -> PyResult<f64> {
        Ok(self.lock()?.rung.motion().1)
    }

    /// Events since the joint was made: break, stick, reverse.
    #[getter]
    fn events(&self) -> PyResult<(u64, u64, u64)> {
        let counts = self.lock()?.rung.counts();
        let counts = counts.first().copied().unwrap_or_default();
        Ok((counts.breaks, counts.sticks, counts.reverses))
    }

    /// The most energy that the shaft got back over any stretch so far, J.
    #[getter]
    fn returned_j(&self) -> PyResult<f64> {
        Ok(self.lock()?.account.returned_j)
    }

    /// Passivity with a torque that acts `delay_steps` later than over the next step: energy stored, J; damping that
    /// sampling needs, N·m·s/rad; largest acceleration, rad/s², and velocity step, rad/s, if they are known.
    fn passivity(&self, delay_steps: f64) -> PyResult<(f64, f64, Option<f64>, Option<f64>)> {
        let passivity = self.passivity_of(delay_steps)?;
        Ok((
            passivity.stored_j,
            passivity.needed_damping_nms_per_rad,
            passivity.most_acceleration_rad_s2,
            passivity.most_velocity_step_rad_s,
        ))
    }

    /// Returns whether a slip can push a shaft of this acceleration, rad/s², and velocity step, rad/s; also where that is not
    /// known.
    fn may_push(&self, acceleration_rad_s2: f64, velocity_step_rad_s: f64) -> PyResult<bool> {
        finite("acceleration_rad_s2", acceleration_rad_s2)?;
        finite("velocity_step_rad_s", velocity_step_rad_s)?;
        let passivity = self.passivity_of(0.0)?;
        let may_push = passivity.may_push(acceleration_rad_s2.abs(), velocity_step_rad_s.abs());
        Ok(may_push.unwrap_or(true))
    }
}

impl Joint {
    fn passivity_of(&self, delay_steps: f64) -> PyResult<Passivity> {
        if !(0.0..=1e6).contains(&delay_steps) {
            return Err(PyValueError::new_err(format!(
                "delay_steps: expected a number from 0 to a million, got {delay_steps}"
            )));
        }
        Passivity::of(&self.settings, self.limits.step_s, delay_steps)
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn lock(&self) -> PyResult<MutexGuard<'_, Alone>> {
        lock(&self.alone)
    }
}

/// Locks joints; fails if another thread uses them, since waiting would hold the GIL that the
/// other may need.
pub(crate) fn lock<T>(joints: &Mutex<T>) -> PyResult<MutexGuard<'_, T>> {
    match joints.try_lock() {
        Ok(inner) => Ok(inner),
        Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
            "another thread is stepping this joint: give each thread its own",
        )),
        Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(
            "a step of this joint has failed: make another one",
        )),
    }
}

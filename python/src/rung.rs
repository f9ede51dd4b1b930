//! Joints in either precision, and the arrays of their steps.

use crate::scene::Scene;
use crate::signals::Signals;
use crepitus_ladder::joints::{Columns, Counts, JointError, Joints, Lanes, Motion};
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::{Parameters, Real, Settings};
use crepitus_scene::scene::{Precision, SolverChoice};
use numpy::{Element, IntoPyArray, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Joints whose precision was chosen by a scene.
#[derive(Clone)]
pub(crate) enum Rung {
    Single(Joints<f32>),
    Double(Joints<f64>),
}

/// Calls a function with the joints of either precision.
macro_rules! with_joints {
    ($rung:expr, $joints:ident => $work:expr) => {
        match $rung {
            Rung::Single($joints) => $work,
            Rung::Double($joints) => $work,
        }
    };
}

/// Columns that steps return, besides torque and phase.
#[derive(Clone, Copy)]
pub(crate) struct Wanted {
    /// θ and θ̇.
    pub(crate) motion: bool,
    /// f64 also of joints in f32.
    pub(crate) double: bool,
    pub(crate) threads: usize,
}

impl Rung {
    /// Joints of a scene, each on a shaft of its speed, rad/s, with parameters of its own.
    pub(crate) fn new(
        scene: &Scene,
        omegas_rad_s: &[f64],
        parameters: &[(String, Vec<f64>)],
    ) -> PyResult<Self> {
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
        let mut all = Vec::with_capacity(omegas_rad_s.len());
        for n in 0..omegas_rad_s.len() {
            let mut settings: Settings = *crepitus.settings;
            for (name, values) in parameters {
                set(&mut settings.parameters, name, values[n]).ok_or_else(|| {
                    scene.refused(
                        &format!("effects.crepitus.{name}"),
                        "expected a parameter of a joint that is a number".to_owned(),
                    )
                })?;
            }
            let settings = settings.validate().map_err(|error| {
                scene.refused("effects.crepitus", format!("joint {n}: {error}"))
            })?;
            all.push(settings);
        }
        let each = all.into_iter().zip(omegas_rad_s);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the precision that was asked for"
        )]
        let rung = match precision {
            Precision::F32 => {
                let each = each.map(|(settings, omega)| (settings, *omega as f32));
                Joints::new(each, solver, step_s).map(Self::Single)
            }
            Precision::F64 => {
                let each = each.map(|(settings, omega)| (settings, *omega));
                Joints::new(each, solver, step_s).map(Self::Double)
            }
        };
        rung.map_err(|error| scene.refused("solver", error.to_string()))
    }

    pub(crate) fn len(&self) -> usize {
        with_joints!(self, joints => joints.len())
    }

    /// Steps all joints by one step.
    pub(crate) fn step(
        &mut self,
        turns_rad: &[f64],
        speeds_rad_s: &[f64],
        is_of_each: bool,
    ) -> PyResult<()> {
        fn step<F: Lanes>(
            joints: &mut Joints<F>,
            turns_rad: &[F],
            speeds_rad_s: &[F],
            is_of_each: bool,
        ) -> Result<(), JointError> {
            joints.step(motion(turns_rad, speeds_rad_s, is_of_each))
        }
        let stepped = match self {
            Self::Double(joints) => step(joints, turns_rad, speeds_rad_s, is_of_each),
            // (A joint alone allocates nothing.)
            Self::Single(joints) if turns_rad.len() == 1 && speeds_rad_s.len() == 1 => step(
                joints,
                &[narrow(turns_rad[0])],
                &[narrow(speeds_rad_s[0])],
                is_of_each,
            ),
            Self::Single(joints) => {
                let of = |numbers: &[f64]| numbers.iter().copied().map(narrow).collect::<Vec<_>>();
                step(joints, &of(turns_rad), &of(speeds_rad_s), is_of_each)
            }
        };
        stepped.map_err(shape)
    }

    /// Steps all joints through arrays of motions that have been checked; returns columns by name, joint by joint.
    /// `on_torques` gets the torques, N·m.
    pub(crate) fn steps<'py>(
        &mut self,
        py: Python<'py>,
        (turns_rad, speeds_rad_s): (&[f64], &[f64]),
        is_of_each: bool,
        wanted: Wanted,
        on_torques: impl FnOnce(&mut dyn Iterator<Item = f64>),
    ) -> PyResult<Bound<'py, PyDict>> {
        match self {
            Self::Double(joints) => {
                let states = steps(py, joints, turns_rad, speeds_rad_s, is_of_each, wanted)?;
                on_torques(&mut states.torque_nm.iter().copied());
                states.into_dict(py, |numbers| numbers)
            }
            Self::Single(joints) => {
                let of = |numbers: &[f64]| numbers.iter().copied().map(narrow).collect::<Vec<_>>();
                let (turns, speeds) = (of(turns_rad), of(speeds_rad_s));
                let states = steps(py, joints, &turns, &speeds, is_of_each, wanted)?;
                on_torques(&mut states.torque_nm.iter().copied().map(f64::from));
                if wanted.double {
                    states.into_dict(py, |numbers| numbers.into_iter().map(f64::from).collect())
                } else {
                    states.into_dict(py, |numbers| numbers)
                }
            }
        }
    }

    pub(crate) fn restart(&mut self, joint: usize, torque_nm: f64, omega_rad_s: f64) {
        match self {
            Self::Single(joints) => {
                joints.restart(joint, narrow(torque_nm), narrow(omega_rad_s));
            }
            Self::Double(joints) => joints.restart(joint, torque_nm, omega_rad_s),
        }
    }

    /// Torque of the first joint, N·m.
    pub(crate) fn torque_nm(&self) -> f64 {
        with_joints!(self, joints => joints.torques_nm().first().copied().unwrap_or_default().to_f64())
    }

    /// (θ, θ̇) of the first joint, rad and rad/s.
    pub(crate) fn motion(&mut self) -> (f64, f64) {
        with_joints!(self, joints => {
            let (theta, theta_dot) = joints.motions().next().unwrap_or_default();
            (theta.to_f64(), theta_dot.to_f64())
        })
    }

    pub(crate) fn torques_nm(&self) -> Vec<f64> {
        with_joints!(self, joints => joints.torques_nm().iter().map(|x| x.to_f64()).collect())
    }

    pub(crate) fn phases(&self) -> &[i8] {
        with_joints!(self, joints => joints.phases())
    }

    /// (θ, θ̇) of each joint, rad and rad/s.
    pub(crate) fn motions(&mut self) -> (Vec<f64>, Vec<f64>) {
        with_joints!(self, joints => joints.motions().map(|(a, b)| (a.to_f64(), b.to_f64())).unzip())
    }

    pub(crate) fn counts(&self) -> Vec<Counts> {
        with_joints!(self, joints => joints.counts().collect())
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the precision that was asked for"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}

fn motion<'a, F>(turns_rad: &'a [F], speeds_rad_s: &'a [F], is_of_each: bool) -> Motion<'a, F> {
    if is_of_each {
        Motion::of_each(turns_rad, speeds_rad_s)
    } else {
        Motion::of_all(turns_rad, speeds_rad_s)
    }
}

fn set(parameters: &mut Parameters, name: &str, value: f64) -> Option<()> {
    let parameter = match name {
        "inertia_kg_m2" => &mut parameters.inertia_kg_m2,
        "stiffness_nm_per_rad" => &mut parameters.stiffness_nm_per_rad,
        "damping_nms_per_rad" => &mut parameters.damping_nms_per_rad,
        "kinetic_torque_nm" => &mut parameters.kinetic_torque_nm,
        "static_torque_nm" => &mut parameters.static_torque_nm,
        _ => return None,
    };
    *parameter = value;
    Some(())
}

fn shape(error: JointError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn steps<F: Lanes>(
    py: Python<'_>,
    joints: &mut Joints<F>,
    turns_rad: &[F],
    speeds_rad_s: &[F],
    is_of_each: bool,
    wanted: Wanted,
) -> PyResult<States<F>> {
    let motion = motion(turns_rad, speeds_rad_s, is_of_each);
    let count = if is_of_each {
        turns_rad.len()
    } else {
        turns_rad.len() * joints.len()
    };
    let mut states = States::of(count, wanted.motion);
    py.detach(|| {
        let mut signals = Signals::new();
        let mut raised = None;
        let columns = states.columns();
        let stepped = joints.steps(motion, columns, wanted.threads, || match signals.check() {
            Ok(()) => true,
            Err(error) => {
                raised = Some(error);
                false
            }
        });
        raised.map_or(stepped.map_err(shape), Err)
    })?;
    Ok(states)
}

/// States after each step, by column.
struct States<F> {
    torque_nm: Vec<F>,
    phase: Vec<i8>,
    theta_rad: Vec<F>,
    theta_dot_rad_s: Vec<F>,
}

impl<F: Lanes> States<F> {
    fn of(count: usize, motion: bool) -> Self {
        let motion = if motion { count } else { 0 };
        Self {
            torque_nm: vec![F::default(); count],
            phase: vec![0; count],
            theta_rad: vec![F::default(); motion],
            theta_dot_rad_s: vec![F::default(); motion],
        }
    }

    fn columns(&mut self) -> Columns<'_, F> {
        Columns {
            torque_nm: &mut self.torque_nm,
            phase: &mut self.phase,
            theta_rad: &mut self.theta_rad,
            theta_dot_rad_s: &mut self.theta_dot_rad_s,
        }
    }

    fn into_dict<T: Element>(
        self,
        py: Python<'_>,
        of: impl Fn(Vec<F>) -> Vec<T>,
    ) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        let has_motion = self.theta_rad.len() == self.torque_nm.len();
        dict.set_item("torque_nm", of(self.torque_nm).into_pyarray(py))?;
        dict.set_item("phase", self.phase.into_pyarray(py))?;
        if has_motion {
            dict.set_item("theta_rad", of(self.theta_rad).into_pyarray(py))?;
            dict.set_item("theta_dot_rad_s", of(self.theta_dot_rad_s).into_pyarray(py))?;
        }
        Ok(dict)
    }
}

/// Rejects a number that is not finite.
pub(crate) fn finite(name: &str, x: f64) -> PyResult<()> {
    if x.is_finite() {
        Ok(())
    } else {
        Err(PyValueError::new_err(format!(
            "{name}: expected a finite number, got {x}"
        )))
    }
}

/// Fastest shaft of a joint, rad/s: what the device's input check takes.
fn most_speed_rad_s(step_s: f64) -> f64 {
    InputLimits::device(step_s).speed_rad_s
}

/// Rounding that a turn may be beyond its limit by, as a share of it.
const ROUNDING: f64 = 1e-9;

/// Largest motion of a shaft in a step.
#[derive(Clone, Copy)]
pub(crate) struct StepLimits {
    pub(crate) step_s: f64,
    turn_rad: f64,
    speed_rad_s: f64,
}

impl StepLimits {
    pub(crate) fn of(scene: &Scene) -> Self {
        let step_s = scene.checked.step_s();
        let speed_rad_s = most_speed_rad_s(step_s) * (1.0 + ROUNDING);
        Self {
            step_s,
            turn_rad: speed_rad_s * step_s,
            speed_rad_s,
        }
    }

    /// Rejects a turn in a step, rad, that no shaft makes.
    pub(crate) fn turn(&self, name: &str, turn_rad: f64) -> PyResult<()> {
        if turn_rad.abs() <= self.turn_rad {
            return Ok(());
        }
        finite(name, turn_rad)?;
        let (most, step_s) = (most_speed_rad_s(self.step_s), self.step_s);
        Err(PyValueError::new_err(format!(
            "{name}: expected at most ±{:.3e} rad in a step of {step_s} s, which is {most} rad/s, got {turn_rad} rad: give the \
             turn of one step, in rad, or make more steps",
            most * step_s
        )))
    }

    /// Rejects a speed, rad/s, that no shaft has.
    pub(crate) fn speed(&self, name: &str, speed_rad_s: f64) -> PyResult<()> {
        if speed_rad_s.abs() <= self.speed_rad_s {
            return Ok(());
        }
        finite(name, speed_rad_s)?;
        let most = most_speed_rad_s(self.step_s);
        Err(PyValueError::new_err(format!(
            "{name}: expected at most ±{most} rad/s, got {speed_rad_s}: no joint moves faster; check its unit"
        )))
    }

    /// Returns the turns and the speeds of arrays, checked before any step is made. Copies: while steps are made without the
    /// GIL, others may write to the arrays.
    pub(crate) fn motions(
        &self,
        dphi_rad: &PyReadonlyArrayDyn<'_, f64>,
        omega_rad_s: &PyReadonlyArrayDyn<'_, f64>,
    ) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let turn = |name: &str, x| self.turn(name, x);
        let speed = |name: &str, x| self.speed(name, x);
        Ok((
            numbers("dphi_rad", dphi_rad, self.turn_rad, turn)?,
            numbers("omega_rad_s", omega_rad_s, self.speed_rad_s, speed)?,
        ))
    }

    /// Returns the speeds of an array.
    pub(crate) fn speeds(&self, omega_rad_s: &PyReadonlyArrayDyn<'_, f64>) -> PyResult<Vec<f64>> {
        let speed = |name: &str, x| self.speed(name, x);
        numbers("omega_rad_s", omega_rad_s, self.speed_rad_s, speed)
    }
}

/// Returns the numbers of an array; `check` has the error of one that is beyond the limit, or not a number.
fn numbers(
    name: &str,
    array: &PyReadonlyArrayDyn<'_, f64>,
    most: f64,
    check: impl Fn(&str, f64) -> PyResult<()>,
) -> PyResult<Vec<f64>> {
    // One pass without a branch, and a second one for the message.
    let mut are_within = true;
    let mut keep = |x: &f64| {
        are_within &= x.abs() <= most;
        *x
    };
    let numbers: Vec<f64> = match array.as_slice() {
        Ok(slice) => slice.iter().map(&mut keep).collect(),
        Err(_) => array.as_array().iter().map(&mut keep).collect(),
    };
    if !are_within {
        for (n, x) in numbers.iter().enumerate() {
            check(&format!("{name}[{n}]"), *x)?;
        }
    }
    Ok(numbers)
}

/// Returns the numbers of an array; rejects it if one is not finite.
pub(crate) fn finite_numbers(
    name: &str,
    array: &PyReadonlyArrayDyn<'_, f64>,
) -> PyResult<Vec<f64>> {
    numbers(name, array, f64::MAX, finite)
}

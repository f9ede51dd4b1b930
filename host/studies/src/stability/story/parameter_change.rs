//! Effect of a change of stiffness on a wound spring: without a thought it
//! injects energy from nowhere; committed and ramped it injects none.

use super::Line;
use crate::sampling::Sampling;
use crate::stability::parameter_changes::SLEW_NM_PER_S;
use crepitus_model::joint::oscillator::Oscillator;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Parameters, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip, Validated,
};
use crepitus_plant::Motion;

/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// Time at which the spring is made forty times stiffer, and time at which it is made soft again, s.
const STIFFER_S: f64 = 0.039;
const SOFTER_S: f64 = 0.09;
/// Duration of the run, s.
const SHOWN_S: f64 = 0.13;
/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterChange {
    /// Ts and Tk, N·m.
    pub levels_nm: (f64, f64),
    /// Times at which the spring is made stiffer, and soft again, s.
    pub changes_s: (f64, f64),
    /// Duration of the run, s.
    pub shown_s: f64,
    /// One step, s.
    pub step_s: f64,
    /// The slew limit of the device, N·m/s.
    pub slew_nm_per_s: f64,
    /// Committed and ramped, as the device does it.
    pub committed: Change,
    /// Replaced as they are.
    pub naive: Change,
}

/// One way to do it; against time, s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Torque, N·m.
    pub torque_nm: Line,
    /// Energy of spring and object, J.
    pub stored_j: Line,
}

impl Change {
    fn add(&mut self, time_s: f64, torque_nm: f64, stored_j: f64) {
        self.torque_nm.push((time_s, torque_nm));
        self.stored_j.push((time_s, stored_j));
    }
}

/// See the module.
pub(super) fn parameter_change() -> Result<ParameterChange, SettingsError> {
    let stiff = Parameters::default();
    let soft = Parameters {
        stiffness_nm_per_rad: 10.0,
        ..stiff
    };
    Ok(ParameterChange {
        levels_nm: (stiff.static_torque_nm, stiff.kinetic_torque_nm),
        changes_s: (STIFFER_S, SOFTER_S),
        shown_s: SHOWN_S,
        step_s: STEP_S,
        slew_nm_per_s: SLEW_NM_PER_S,
        committed: committed(&valid(soft)?, &valid(stiff)?)?,
        naive: naive(&soft, &stiff)?,
    })
}

fn valid(parameters: Parameters) -> Result<Validated<Settings>, SettingsError> {
    Settings {
        parameters,
        ..Settings::default()
    }
    .validate()
}

/// Energy of spring and motion, J.
fn energy_j(a: &StepCoefficients<f64>, theta: f64, theta_dot: f64) -> f64 {
    0.5 * a.stiffness * theta * theta + 0.5 * a.inertia * theta_dot * theta_dot
}

/// The real joint, with the device's commits.
fn committed(
    soft: &Validated<Settings>,
    stiff: &Validated<Settings>,
) -> Result<Change, SettingsError> {
    let (soft, stiff) = (
        StepCoefficients::new(soft, STEP_S)?,
        StepCoefficients::new(stiff, STEP_S)?,
    );
    let motion = Motion::constant(OMEGA_RAD_S);
    let sampling = Sampling::new(&motion, SHOWN_S, STEP_S);
    let mut joint = Frozen::<f64, ExactEvents>::new(soft, OMEGA_RAD_S);
    let mut ramp = Ramp::at(soft);
    let mut lines = Change::default();
    let mut walk = sampling.walk_from(0);
    let mut chunk: Vec<ShaftStep<f64>> = Vec::new();
    for n in 0..sampling.steps() {
        walk.fill(&mut chunk, 1);
        let now_s = sampling.time_s(n, 0.0);
        let due = |at_s: f64| (now_s - at_s).abs() < 0.5 * STEP_S;
        if due(STIFFER_S) {
            ramp = Ramp::new(*joint.coefficients(), stiff, SLEW_NM_PER_S);
        } else if due(SOFTER_S) {
            ramp = Ramp::new(*joint.coefficients(), soft, SLEW_NM_PER_S);
        }
        if let Some(next) = ramp.advance() {
            joint.adjust(next);
        }
        for shaft in &chunk {
            joint.step(shaft, |_| {});
        }
        lines.add(
            sampling.time_s(n + 1, 0.0),
            joint.torque_nm(),
            energy_j(
                joint.coefficients(),
                joint.theta_rad(),
                joint.theta_dot_rad_s(),
            ),
        );
    }
    Ok(lines)
}

/// Solution of the equations if the numbers are replaced and the state is not
/// looked at: the stick's angle goes on, and the far too strong spring swings.
fn naive(soft: &Parameters, stiff: &Parameters) -> Result<Change, SettingsError> {
    let swing = Oscillator::<f64>::of(stiff).transition(STEP_S);
    let soft: StepCoefficients<f64> = StepCoefficients::new(&valid(*soft)?, STEP_S)?;
    let stiff = StepCoefficients::new(&valid(*stiff)?, STEP_S)?;
    let mut lines = Change::default();
    let mut time_s = 0.0;
    while time_s < STIFFER_S - 0.5 * STEP_S {
        time_s += STEP_S;
        let theta = OMEGA_RAD_S * time_s;
        let energy = energy_j(&soft, theta, OMEGA_RAD_S);
        lines.add(time_s, soft.stiffness * theta, energy);
    }
    let theta = OMEGA_RAD_S * time_s;
    let (mut x, mut v) = (theta - stiff.kinetic_angle_rad, OMEGA_RAD_S);
    time_s += STEP_S;
    let energy = energy_j(&stiff, theta, v);
    lines.add(time_s, stiff.stiffness * theta, energy);
    while time_s < SOFTER_S {
        time_s += STEP_S;
        (x, v) = swing.apply(x, v);
        let energy = energy_j(&stiff, x + stiff.kinetic_angle_rad, v);
        lines.add(time_s, stiff.kinetic_nm, energy);
    }
    Ok(lines)
}

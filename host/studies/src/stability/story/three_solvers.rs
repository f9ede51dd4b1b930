//! One joint under three solvers: the exact one that the device runs, explicit Euler and implicit Euler.

use super::Line;
use super::trace::Run;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Settings, SettingsError};
use crepitus_plant::Motion;

/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// Duration of the run, s: three cycles.
const SHOWN_S: f64 = 0.1;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreeSolvers {
    /// Parameters of the joint.
    pub parameters: Parameters,
    /// Speed of the shaft, rad/s.
    pub omega_rad_s: f64,
    /// Step, s.
    pub step_s: f64,
    /// Duration, s.
    pub shown_s: f64,
    /// The exact solver, explicit Euler, implicit Euler.
    pub curves: Vec<Curve>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The solver.
    pub solver: Solver,
    /// Torque, N·m, against time, s.
    pub torque_nm: Line,
    /// Number of times that the object broke loose.
    pub breaks: usize,
}

impl Curve {
    /// The least torque, N·m: below 2Tk − Ts it pushes the leg along.
    pub fn least_nm(&self) -> f64 {
        let torques = self.torque_nm.iter().map(|(_, nm)| *nm);
        torques.fold(f64::INFINITY, f64::min)
    }
}

/// See the module.
pub(super) fn three_solvers() -> Result<ThreeSolvers, SettingsError> {
    let settings = Settings {
        convention: Convention::Physical,
        ..Settings::default()
    }
    .validate()?;
    let motion = Motion::constant(OMEGA_RAD_S);
    let curve = |solver| {
        let run = Run {
            settings: &settings,
            solver,
            motion: &motion,
            duration_s: SHOWN_S,
            step_s: STEP_S,
        };
        let trace = run.trace()?;
        Ok(Curve {
            solver,
            torque_nm: trace.torque_nm,
            breaks: trace.breaks_s.len(),
        })
    };
    Ok(ThreeSolvers {
        parameters: settings.parameters,
        omega_rad_s: OMEGA_RAD_S,
        step_s: STEP_S,
        shown_s: SHOWN_S,
        curves: [Solver::ExactEvents, Solver::Euler, Solver::ImplicitEuler]
            .into_iter()
            .map(curve)
            .collect::<Result<_, SettingsError>>()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_one_gains_energy_and_one_heals() {
        let story = three_solvers().unwrap();
        let breaks: Vec<usize> = story.curves.iter().map(|curve| curve.breaks).collect();
        assert_eq!(breaks, [4, 4, 1]);
        let least: Vec<f64> = story.curves.iter().map(Curve::least_nm).collect();
        // 2Tk − Ts is 0.
        assert!(
            least[0].abs() < 1e-3 && least[1] < -0.3 && least[2].abs() < 1e-3,
            "{least:?}"
        );
    }
}

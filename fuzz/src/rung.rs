//! Valid settings, a solver and a step, made of bytes.

use crate::bytes::Bytes;
use crepitus_model::joint::LONGEST_STEP_S;
use crepitus_model::parameters::Tabled;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Restart, Settings, Validated};

/// Inputs of a joint.
pub(crate) struct Rung {
    pub(crate) settings: Validated<Settings>,
    pub(crate) solver: Solver,
    pub(crate) step_s: f64,
    /// Double precision, not single.
    pub(crate) double: bool,
}

impl Rung {
    /// Any rung of the ladder with any settings in range, their ends included.
    pub(crate) fn of(bytes: &mut Bytes<'_>) -> Self {
        let convention = bytes.choice(&Convention::ALL);
        let solvers = Solver::ALL.into_iter();
        let solvers: Vec<_> = solvers
            .filter(|s| s.refusal(convention).is_none())
            .collect();
        let solver = bytes.choice(&solvers);
        Self {
            solver,
            double: bytes.choice(&[false, true]) || solver.single_refusal().is_some(),
            step_s: step_s(bytes),
            settings: settings(bytes, convention),
        }
    }

    /// Returns whether the method has laws with this step: explicit methods have none
    /// beyond their limit of stability.
    pub(crate) fn is_lawful(&self) -> bool {
        let p = &self.settings.parameters;
        let radians = p.natural_rad_s() * self.step_s;
        let damped = p.damping_nms_per_rad / p.inertia_kg_m2 * self.step_s;
        let explicit = matches!(
            self.solver,
            Solver::Euler
                | Solver::SemiImplicitEuler
                | Solver::Verlet
                | Solver::Rk4
                | Solver::Rk4Events
        );
        // A free swing grows with Euler's method at any step: by radians²/2 a
        // step, which over a thousand steps must not overflow single precision.
        let most_radians = if matches!(self.solver, Solver::Euler) {
            0.2
        } else {
            0.5
        };
        !(explicit && (radians > most_radians || damped > 0.5))
    }
}

/// A step from a nanosecond to the longest that is allowed.
pub(crate) fn step_s(bytes: &mut Bytes<'_>) -> f64 {
    bytes.between(1e-9, LONGEST_STEP_S)
}

/// Settings that are valid under `convention`.
pub(crate) fn settings(bytes: &mut Bytes<'_>, convention: Convention) -> Validated<Settings> {
    let frozen = convention == Convention::Frozen;
    let restart = bytes.choice(&Restart::ALL);
    let [inertia, stiffness, damping, _, static_torque] = Parameters::TABLE;
    let inertia_kg_m2 = bytes.between(inertia.min, inertia.max);
    let stiffness_nm_per_rad = bytes.between(stiffness.min, stiffness.max);
    let damping_nms_per_rad = bytes.between(damping.min, damping.max);
    let static_torque_nm = bytes.between(static_torque.min, static_torque.max);
    let settings = Settings {
        parameters: Parameters {
            inertia_kg_m2,
            stiffness_nm_per_rad,
            damping_nms_per_rad: if frozen { 0.0 } else { damping_nms_per_rad },
            kinetic_torque_nm: static_torque_nm * bytes.part(),
            static_torque_nm,
        },
        convention,
        restart: if frozen { restart } else { Restart::Elastic },
    };
    settings.validate().expect("settings made to be valid")
}

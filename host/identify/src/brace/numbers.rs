//! Parameters of a brace with a weight in its cuffs, those to be estimated and those that were
//! measured.

use crepitus_plant::effects::drivetrain::Gear;
use crepitus_plant::swing::WeightedBrace;

/// Number of parameters.
pub(crate) const NUMBERS: usize = 11;

/// Indices of parameters in the array.
pub(crate) mod place {
    pub(crate) const FRICTION: usize = 0;
    pub(crate) const LOAD_LOSS: usize = 1;
    pub(crate) const VISCOUS: usize = 2;
    pub(crate) const ROTOR: usize = 3;
    pub(crate) const BRACE: usize = 4;
    pub(crate) const GAP: usize = 5;
    pub(crate) const STIFFNESS: usize = 6;
    pub(crate) const DAMPING: usize = 7;
    pub(crate) const MOMENT: usize = 8;
    pub(crate) const WEIGHT: usize = 9;
    /// Torque of the motor over its nominal one, from current and torque constant.
    pub(crate) const TORQUE_SCALE: usize = 10;
}

/// Smallest values that the model can be computed with: no negative inertia, and no gap that closes
/// within a step.
pub(crate) const LEAST: [f64; NUMBERS] = [
    0.0, -0.5, -1.0, 1e-3, 5e-4, 1e-4, 2.0, 0.0, 1e-2, 1e-3, 0.05,
];

/// Largest values: the time constant of a stiffer cuff is shorter than a step.
pub(crate) const MOST: [f64; NUMBERS] = [
    50.0, 3.0, 20.0, 5.0, 2.0, 0.5, 3000.0, 30.0, 500.0, 50.0, 20.0,
];

/// Returns the brace that is simulated with these parameters.
pub(crate) fn weighted_brace(numbers: &[f64; NUMBERS]) -> WeightedBrace {
    WeightedBrace {
        gear: Gear {
            inertia_kg_m2: numbers[place::ROTOR],
            friction_nm: numbers[place::FRICTION],
            load_loss: numbers[place::LOAD_LOSS],
        },
        gap_rad: numbers[place::GAP],
        brace_kg_m2: numbers[place::BRACE],
        stiffness_nm: numbers[place::STIFFNESS],
        damping_nms: numbers[place::DAMPING],
        moment_nm: numbers[place::MOMENT],
        weight_kg_m2: numbers[place::WEIGHT],
        viscous_nms: numbers[place::VISCOUS],
    }
}

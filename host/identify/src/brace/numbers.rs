//! Parameters of a brace with a weight in its cuffs, those to be estimated and those that were
//! measured.

use crepitus_plant::effects::drivetrain::Gear;
use crepitus_plant::swing::{BY_ANGLE, Imperfections, WeightedBrace};

/// Number of parameters.
pub(crate) const NUMBERS: usize = place::ENCODER + 1;

/// Half the range of a friction that varies with the angle, rad.
pub(crate) const RANGE_RAD: f64 = 1.1;

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
    /// Imperfections, zero in a perfect brace: what a fit marginalises over.
    pub(crate) const PRESLIDING: usize = 11;
    pub(crate) const TEETH: usize = 12;
    pub(crate) const STRIBECK: usize = 13;
    /// The first of several.
    pub(crate) const BY_ANGLE: usize = 14;
    /// Angles of the encoder over the true ones, less one.
    pub(crate) const ENCODER: usize = BY_ANGLE + super::BY_ANGLE;
}

/// Smallest values that the model can be computed with: no negative inertia, and no gap that closes
/// within a step.
pub(crate) const LEAST: [f64; NUMBERS] = [
    0.0, -0.5, -1.0, 1e-3, 5e-4, 1e-4, 2.0, 0.0, 1e-2, 1e-3, 0.05, 5e-6, 5e-6, -0.5, -0.5, -0.5,
    -0.5, -0.5, -0.2,
];

/// Largest values: a stiffer cuff is none.
pub(crate) const MOST: [f64; NUMBERS] = [
    50.0, 3.0, 20.0, 5.0, 2.0, 0.5, 2e4, 30.0, 500.0, 50.0, 20.0, 5e-3, 5e-3, 2.0, 0.5, 0.5, 0.5,
    0.5, 0.2,
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
        imperfections: Imperfections {
            presliding_rad_per_nm: numbers[place::PRESLIDING],
            teeth_rad_per_nm: numbers[place::TEETH],
            stribeck: numbers[place::STRIBECK],
            by_angle: std::array::from_fn(|term| numbers[place::BY_ANGLE + term]),
            range_rad: RANGE_RAD,
        },
    }
}

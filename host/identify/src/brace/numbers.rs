//! Parameters of a brace with a weight in its cuffs, those to be estimated and those that were
//! measured.

/// Number of parameters.
pub(crate) const NUMBERS: usize = 11;

/// Parameters of a brace with its weight; angles are those of the joint, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Numbers {
    /// Dry friction of motor and gear, N·m.
    pub(crate) friction_nm: f64,
    /// Share of the motor's torque that the gear loses.
    pub(crate) load_loss: f64,
    /// Viscous damping about the axis, N·m·s/rad.
    pub(crate) viscous_nms: f64,
    /// Inertia of the rotor, kg·m².
    pub(crate) rotor_kg_m2: f64,
    /// Inertia of the brace between gear and cuffs, kg·m².
    pub(crate) brace_kg_m2: f64,
    /// Lost motion of the gear, rad.
    pub(crate) gap_rad: f64,
    /// Stiffness of the cuffs, N·m/rad.
    pub(crate) stiffness_nm: f64,
    /// Damping of the cuffs, N·m·s/rad.
    pub(crate) damping_nms: f64,
    /// Moment of the weight when it is horizontal, N·m.
    pub(crate) moment_nm: f64,
    /// Inertia of the weight about the axis, kg·m².
    pub(crate) weight_kg_m2: f64,
    /// Torque of the motor over its nominal one, from current and torque constant.
    pub(crate) torque_scale: f64,
}

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

impl From<[f64; NUMBERS]> for Numbers {
    fn from(n: [f64; NUMBERS]) -> Self {
        Self {
            friction_nm: n[0],
            load_loss: n[1],
            viscous_nms: n[2],
            rotor_kg_m2: n[3],
            brace_kg_m2: n[4],
            gap_rad: n[5],
            stiffness_nm: n[6],
            damping_nms: n[7],
            moment_nm: n[8],
            weight_kg_m2: n[9],
            torque_scale: n[10],
        }
    }
}
